/* SPDX-License-Identifier: Apache-2.0
 *
 * What each binding's benchmark does, in C: loads a saved scene and rays, traces the rays several
 * times in one batch, and prints the seconds of each time.
 *
 *   trace_file SCENE.kiwami RAYS ROUNDS      RAYS: a file of kiwami_ray */
#define _POSIX_C_SOURCE 199309L
#include <kiwami/kiwami.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static void require(int is_right, const char* what) {
  if (is_right) return;
  fprintf(stderr, "trace_file: %s failed\n", what);
  exit(1);
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

int main(int argument_count, char** arguments) {
  kiwami_device* device;
  kiwami_scene* scene;
  kiwami_load_desc desc;
  require(argument_count == 4, "reading the arguments SCENE RAYS ROUNDS");
  FILE* const file = fopen(arguments[2], "rb");
  require(file != NULL && fseek(file, 0, SEEK_END) == 0, "opening the rays");
  const size_t count = (size_t)ftell(file) / sizeof(kiwami_ray);
  rewind(file);
  kiwami_ray* const rays = malloc(count * sizeof(*rays));
  kiwami_hit* const hits = malloc(count * sizeof(*hits));
  require(rays && hits && fread(rays, sizeof(*rays), count, file) == count, "reading the rays");
  fclose(file);
  require(kiwami_device_create(NULL, &device) == KIWAMI_OK, "making a device");
  kiwami_load_desc_init(&desc, sizeof(desc));
  desc.path = arguments[1];
  desc.flags = KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED;
  require(kiwami_scene_load(device, &desc, &scene) == KIWAMI_OK, "loading the scene");
  for (int round = atoi(arguments[3]); round > 0; --round) {
    const double began = now();
    require(kiwami_closest_hit(scene, rays, 0, hits, 0, count, NULL) == KIWAMI_OK, "tracing");
    printf("%.6f\n", now() - began);
  }
  kiwami_scene_release(scene);
  kiwami_device_release(device);
  free(rays);
  free(hits);
  return 0;
}
