# SPDX-License-Identifier: Apache-2.0
# Option ROM at 0xd0000: load kernel and initramfs, enter the kernel in long mode.
# RAM: 0x10000 boot_params, 0x11000 command line, 0x11ff0 sectors of kernel and
# initramfs, 0x12000 page tables, 0x1000000 kernel, boot_params.ramdisk_image initramfs.
        .code16
        .globl  _start
_start: .byte   0x55, 0xaa, 2           # signature, size in 512-byte blocks
        jmp     init                    # the BIOS calls offset 3
gdt:    .quad   0
        .quad   0
        .quad   0x00af9a000000ffff      # 0x10 __BOOT_CS: 64-bit code
        .quad   0x00cf92000000ffff      # 0x18 __BOOT_DS: flat data
        .quad   0x00cf9a000000ffff      # 0x20 flat 32-bit code
gdtend:
gdtr:   .word   gdtend - gdt - 1
        .long   0xd0000 + gdt
init:   cli
        cld
        mov     $0x1000, %ax            # memory map: INT 15h e820 -> boot_params
        mov     %ax, %es
        mov     $0x2d0, %di
        xor     %ebx, %ebx
1:      mov     $0xe820, %eax
        mov     $0x534d4150, %edx
        mov     $20, %ecx
        int     $0x15
        jc      2f
        add     $20, %di
        incb    %es:0x1e8
        test    %ebx, %ebx
        jnz     1b
2:      cli
        in      $0x92, %al              # A20 on
        or      $2, %al
        and     $0xfe, %al
        out     %al, $0x92
        mov     %cs, %ax
        mov     %ax, %ds
        lgdtl   gdtr
        mov     %cr0, %eax
        or      $1, %al
        mov     %eax, %cr0
        ljmpl   $0x20, $0xd0000 + pm32
        .code32
pm32:   mov     $0x18, %eax
        mov     %eax, %ds
        mov     %eax, %es
        mov     %eax, %ss
        mov     $0x20000, %esp
        mov     $0x1000000, %edi        # kernel from the master disk
        mov     0x11ff0, %ebp
        mov     $0xe0, %bl
        call    load
        mov     0x10218, %edi           # initramfs from the slave disk
        mov     0x11ff4, %ebp
        mov     $0xf0, %bl
        call    load
        xor     %eax, %eax              # identity map 4 GiB with 2 MiB pages
        mov     $0x12000, %edi
        mov     $0x1800, %ecx
        rep stosl
        movl    $0x13003, 0x12000
        mov     $0x14003, %eax
        mov     $0x13000, %edi
        mov     $4, %ecx
1:      mov     %eax, (%edi)
        add     $0x1000, %eax
        add     $8, %edi
        loop    1b
        mov     $0x83, %eax
        mov     $0x14000, %edi
        mov     $2048, %ecx
1:      mov     %eax, (%edi)
        add     $0x200000, %eax
        add     $8, %edi
        loop    1b
        mov     $0x20, %eax             # CR4.PAE, CR3, EFER.LME, CR0.PG
        mov     %eax, %cr4
        mov     $0x12000, %eax
        mov     %eax, %cr3
        mov     $0xc0000080, %ecx
        rdmsr
        or      $0x100, %eax
        wrmsr
        mov     %cr0, %eax
        or      $0x80000000, %eax
        mov     %eax, %cr0
        ljmp    $0x10, $0xd0000 + lm64

# Read %ebp sectors from sector 0 of the drive in %bl to %edi (polled ATA PIO, LBA28).
load:   xor     %esi, %esi
1:      mov     $0x1f6, %edx
        mov     %esi, %eax
        shr     $24, %eax
        or      %bl, %al
        out     %al, %dx
        mov     $0x1f2, %edx            # count: 0 stands for 256
        xor     %eax, %eax
        out     %al, %dx
        inc     %edx
        mov     %esi, %eax
        out     %al, %dx
        inc     %edx
        shr     $8, %eax
        out     %al, %dx
        inc     %edx
        shr     $8, %eax
        out     %al, %dx
        mov     $0x1f7, %edx
        mov     $0x20, %al              # READ SECTORS
        out     %al, %dx
        mov     $256, %ecx
2:      push    %ecx
3:      mov     $0x1f7, %edx
        in      %dx, %al
        test    $0x80, %al
        jnz     3b
        test    $0x08, %al
        jz      3b
        mov     $0x1f0, %edx
        mov     $128, %ecx
        rep insl
        pop     %ecx
        loop    2b
        add     $256, %esi
        sub     $256, %ebp
        ja      1b
        ret
        .code64
lm64:   mov     $0x10000, %esi          # boot_params
        mov     $0x1000000, %eax        # startup_64
        jmp     *%rax
        .org    1024
