/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: committed scenes, trees and lights as files: saved, loaded by copy, or mapped without a
 * copy.
 *
 * A file holds a directory of typed, versioned sections, each with its checksum; numbers are little
 * endian, references are offsets, so that it serves at any address. docs/files.md has the layout.
 *
 * By default nothing in a file is believed: checksums first, then every count, index, reference and
 * box that the library relies on. What a load refuses leaves nothing behind. The memory that a load
 * takes is bounded by the size of the file, the time is about linear in it.
 */
#ifndef KIWAMI_IO_H
#define KIWAMI_IO_H

#include "bvh.h"
#include "light.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Takes size bytes, which follow those of the call before. Returns 0, or any other number when it
 * could not (reported as KIWAMI_ERROR_CALLBACK). Called on the thread that saves. */
typedef int32_t (*kiwami_write)(void* user, const void* data, size_t size);

/* Gives up to size bytes, which follow those of the call before: returns how many, 0 at the end, a
 * negative number when it could not (reported as KIWAMI_ERROR_CALLBACK). Called on the thread that
 * loads. */
typedef int64_t (*kiwami_read)(void* user, void* data, size_t size);

/* Where to save: to one of path, write and data. With none of them only the size is found out. */
typedef struct kiwami_save_desc {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_save_desc_init */
  uint32_t flags;       /* 0 */
  const char* path;     /* of a file. It is written beside and renamed when all bytes are on the
                         * disk: whatever happens before leaves a file of that name as it was. What
                         * is no regular file (a pipe, a device) is written to directly. */
  kiwami_write write;
  void* write_user;
  void* data;        /* capacity bytes, at any address */
  uint64_t capacity; /* 0 without data */
} kiwami_save_desc;

enum {
  /* Take no copy: a file is mapped, and data is used where it lies, at a multiple of 64. Both must
   * stay unchanged, and data must stay readable, until the last reference to what was loaded, or to
   * anything made from it, is gone. Files that kiwami_scene_save replaces stay whole for those who
   * have mapped them; a file that is cut by other means ends the process that reads it. Where
   * a file cannot be mapped (a pipe), and with read, bytes are copied nevertheless. */
  KIWAMI_LOAD_MAP = 1u << 0,
  /* Check nothing but the directory: with KIWAMI_LOAD_MAP a scene is ready as soon as its file is
   * mapped, and pages are read when rays come to them. Only for bytes that this library wrote and
   * that nobody else could change: others can crash the process, or worse. */
  KIWAMI_LOAD_TRUSTED = 1u << 1
};

/* What to load: one of path, read and data. */
typedef struct kiwami_load_desc {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_load_desc_init */
  uint32_t flags;       /* KIWAMI_LOAD_* */
  const char* path;
  kiwami_read read;
  void* read_user;
  const void* data;   /* size bytes */
  uint64_t size;      /* 0 without data */
  uint32_t bvh_width; /* 4, 8 or 16: a scene whose trees are of another width is built anew from
                       * its geometries, with its parameters, and so is each that it shows; 0:
                       * whatever is there. For scenes alone. */
  uint32_t reserved;  /* 0 */
} kiwami_load_desc;

/* What a file holds. The numbers are pinned. */
enum { KIWAMI_FILE_SCENE = 1, KIWAMI_FILE_BVH = 2, KIWAMI_FILE_LIGHTS = 3 };

/* How a file fits this library and a device. */
enum {
  KIWAMI_FIT_NATIVE = 0, /* the device's ISA has kernels of its width; also any tree to look at */
  KIWAMI_FIT_SCALAR = 1, /* it has none: rays are traced, with the same answers, by scalar kernels.
                          * kiwami_load_desc.bvh_width gives a tree of a width that has some. */
  KIWAMI_FIT_NONE = 2    /* a newer library wrote it: it cannot be loaded */
};

/* What the beginning of a file says. */
typedef struct kiwami_file_info {
  uint32_t struct_size;     /* set by the caller to sizeof(kiwami_file_info) */
  uint32_t kind;            /* KIWAMI_FILE_* */
  uint32_t fit;             /* KIWAMI_FIT_*; of the fields below only the versions, file_bytes and
                             * section_count are told where it is NONE */
  uint32_t format_version;  /* of the file; this library writes KIWAMI_FILE_FORMAT_VERSION */
  uint32_t library_version; /* that wrote it, as kiwami_version */
  uint32_t bvh_width;       /* children a node */
  uint32_t section_count;
  uint32_t reserved; /* 0 */
  uint64_t file_bytes;
  uint64_t triangle_count; /* of a scene, that can be hit, without those of instances; of a tree,
                            * entries of primitives; of a set of lights, its lights */
  uint64_t node_count;
} kiwami_file_info;

#define KIWAMI_FILE_FORMAT_VERSION 2

/* Fill a struct with its defaults: nowhere to save to, nothing to load, everything checked.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_save_desc_init(kiwami_save_desc* desc, size_t size);
KIWAMI_API kiwami_result kiwami_load_desc_init(kiwami_load_desc* desc, size_t size);

/* Saves what the last commit made of a scene: all trees, the geometries of every kind with their
 * masks and numbers, opacity micromaps, and the scenes that instances show, as they were committed
 * then, each once however often it is shown. Buffers that are shared with the caller are saved as
 * they are now, but the transforms of instances also as they were. What is attached beside,
 * disabled or since the commit, comes along without having been committed; so do the parameters of
 * the next commit. Equal scenes give equal bytes. Representative rays are not saved.
 *   bytes     receives the size of the file, also where it did not fit into data. May be NULL.
 *   errors    INVALID_ARGUMENT: scene or desc is NULL, a field of desc, data that is too small;
 *             INVALID_STATE: never committed, the scene or one that it shows; a user geometry,
 *             which the sentence names: files cannot hold functions; TOO_LARGE: attached geometries
 *             make paths of more than KIWAMI_MAX_INSTANCE_DEPTH instances; IO: a file could not be
 *             written; CALLBACK: write failed; OUT_OF_MEMORY
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_save(const kiwami_scene* scene, const kiwami_save_desc* desc,
                                           uint64_t* bytes);

/* Makes a scene of a file. It is a committed scene like others: it can be traced, looked at, saved,
 * changed and committed again, its geometries and the scenes that they show being objects of the
 * device that nobody else holds. No tree is built: all lie where the file is.
 *   scene     receives the handle, with one reference, or NULL on error
 *   errors    INVALID_ARGUMENT: NULL, a field of desc; IO: a file could not be read; INVALID_FILE:
 *             no file of a scene, one of a newer library, or a damaged one (the sentence says
 *             where); CALLBACK: read or the runner failed; TOO_LARGE; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_load(kiwami_device* device, const kiwami_load_desc* desc,
                                           kiwami_scene** scene);

/* Saves a tree of kiwami_bvh_build, with its boxes or its mesh.
 *   errors    as kiwami_scene_save; INVALID_STATE: the tree of a scene, with which it is saved
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_save(const kiwami_bvh* bvh, const kiwami_save_desc* desc,
                                         uint64_t* bytes);

/* Makes a tree of a file. It is like one of kiwami_bvh_build; its nodes are always copied.
 *   bvh       receives the handle, with one reference, or NULL on error
 *   errors    as kiwami_scene_load
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_load(kiwami_device* device, const kiwami_load_desc* desc,
                                         kiwami_bvh** bvh);

/* Saves what the last commit or refit made of a set of lights: the lights, the instances with the
 * trees that they show, each once however often it is shown, and the shape of the tree. Changes
 * since are not saved. Equal sets give equal bytes.
 *   errors    as kiwami_scene_save; INVALID_STATE: never committed
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_save(const kiwami_light_tree* tree,
                                                const kiwami_save_desc* desc, uint64_t* bytes);

/* Makes a set of lights of a file: a committed one like others, to be sampled, changed, refitted
 * and committed, with choices and probabilities equal to the bit. The tree is not built but written
 * anew in its shape, in linear time, whatever the flags are: nothing of the file is needed after
 * the call.
 *   tree      receives the handle, with one reference, or NULL on error
 *   errors    as kiwami_scene_load
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_load(kiwami_device* device, const kiwami_load_desc* desc,
                                                kiwami_light_tree** tree);

/* Says what a file is, and whether it fits the device, from its beginning alone.
 *   desc      path or data; flags have no effect
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: NULL, a field of desc, struct_size below 8; IO; INVALID_FILE: not a
 *             file of this library, or a damaged beginning; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_file_get_info(kiwami_device* device, const kiwami_load_desc* desc,
                                              kiwami_file_info* info);

#ifdef __cplusplus
}
#endif

#endif
