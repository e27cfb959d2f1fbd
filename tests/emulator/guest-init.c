/* SPDX-License-Identifier: Apache-2.0
 * PID 1 of the guest: run one program, send its output and exit status to the host, switch off.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/io.h>
#include <sys/klog.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LPT1 = 0x378, LPT2 = 0x278, COM1 = 0x3f8 };

/* Bochs appends each byte to the file behind the parallel port. */
static void lpt(int base, const char* s, size_t n) {
  for (size_t i = 0; i < n; i++) {
    outb(s[i], base);
    outb(0x0d, base + 2); /* strobe */
    outb(0x0c, base + 2);
  }
}

/* Reports the status on the serial port and ends the emulator. */
static void finish(const char* status) {
  const char* off = "Shutdown";
  for (const char* p = status; *p; p++) {
    while (!(inb(COM1 + 5) & 0x20))
      ;
    outb(*p, COM1);
  }
  while (!(inb(COM1 + 5) & 0x40))
    ;
  for (; *off; off++) outb(*off, 0x8900);
  for (;;) pause();
}

/* A file of NUL-terminated strings as a vector. */
static char** strings(const char* path) {
  static char* none[1];
  size_t size = 0, cap = 1 << 22, count = 0;
  char* buf = malloc(cap);
  int fd = open(path, O_RDONLY);
  ssize_t n;
  if (fd < 0) return none;
  while (size < cap && (n = read(fd, buf + size, cap - size)) > 0) size += n;
  close(fd);
  for (size_t i = 0; i < size; i++) count += !buf[i];
  char** v = calloc(count + 1, sizeof *v);
  size_t k = 0;
  for (size_t i = 0; i < size; i += strlen(buf + i) + 1) v[k++] = buf + i;
  return v;
}

/* The child: the program in its working directory, with the pipes as its output. */
static void run_program(char** argv, char** envp, char** cwd, int out, int err) {
  int null = open("/dev/null", O_RDONLY);
  iopl(0);
  setsid();
  dup2(null, 0);
  dup2(out, 1);
  dup2(err, 2);
  for (int fd = 3; fd < 16; fd++) close(fd);
  if (!cwd[0] || chdir(cwd[0])) perror("guest: chdir");
  execve(argv[0], argv, envp);
  perror("guest: execve");
  _exit(127);
}

/* Sends what the pipes bring to the parallel ports until the program has ended; its status. */
static int forward_output(pid_t child, int out, int err) {
  static char buf[65536];
  struct pollfd p[2] = {{out, POLLIN, 0}, {err, POLLIN, 0}};
  int gone = 0, status = 0;
  while (p[0].fd >= 0 || p[1].fd >= 0) {
    /* A grandchild may hold the pipes: once the program is gone, drain, then stop. */
    int n = poll(p, 2, gone ? 0 : 200);
    if (n == 0) {
      if (gone) break;
      gone = waitpid(child, &status, WNOHANG) == child;
      continue;
    }
    for (int i = 0; i < 2; i++) {
      if (p[i].fd < 0 || !p[i].revents) continue;
      ssize_t r = read(p[i].fd, buf, sizeof buf);
      if (r > 0)
        lpt(i ? LPT2 : LPT1, buf, r);
      else
        p[i].fd = -1;
    }
  }
  while (!gone) gone = waitpid(child, &status, 0) == child;
  return status;
}

/* Says on stderr which signal ended the program, and what the kernel logged about it. */
static void report_signal(int number) {
  static char log[65536];
  char line[200];
  int n =
      snprintf(line, sizeof line, "guest: killed by signal %d (%s)\n", number, strsignal(number));
  lpt(LPT2, line, n);
  n = klogctl(3, log, sizeof log);
  if (n > 0) lpt(LPT2, log, n);
}

int main(void) {
  char line[200];
  int out[2], err[2];

  umask(022);
  mount("devtmpfs", "/dev", "devtmpfs", 0, 0);
  mkdir("/dev/shm", 01777);
  mount("tmpfs", "/dev/shm", "tmpfs", 0, 0);
  mount("proc", "/proc", "proc", 0, 0);
  mount("sysfs", "/sys", "sysfs", 0, 0);
  if (iopl(3)) return 1;
  outb(0x0c, LPT1 + 2);
  outb(0x0c, LPT2 + 2);

  char** argv = strings("/.run/args");
  char** envp = strings("/.run/env");
  char** cwd = strings("/.run/cwd");
  if (!argv[0] || pipe(out) || pipe(err)) return 1;
  klogctl(5, 0, 0); /* clear: only messages from here on count */
  pid_t child = fork();
  if (child == 0) run_program(argv, envp, cwd, out[1], err[1]);
  close(out[1]);
  close(err[1]);
  int status = forward_output(child, out[0], err[0]);
  if (WIFSIGNALED(status)) report_signal(WTERMSIG(status));
  snprintf(line, sizeof line, "\nGUEST-STATUS %d\n",
           WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status));
  finish(line);
}
