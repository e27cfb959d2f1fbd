/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: many lights: trees over lights, from which receivers choose in proportion to what each
 * light can contribute to them. See docs/lights.md.
 *
 * Which light is chosen, and with which probability, is the same to the bit on every ISA and for
 * every number of threads. A light that can contribute to a receiver has a probability above 0:
 * dividing its contribution by its probability gives an unbiased estimate of the sum over all
 * lights. Occlusion is not looked at.
 */
#ifndef KIWAMI_LIGHT_H
#define KIWAMI_LIGHT_H

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle of a set of lights with the tree over them. It holds its device.
 * Adding and setting takes effect with the next kiwami_light_tree_commit or
 * kiwami_light_tree_refit. */
typedef struct kiwami_light_tree kiwami_light_tree;

enum {
  KIWAMI_LIGHT_POINT = 0,      /* point 0; shines in all directions */
  KIWAMI_LIGHT_SPOT = 1,       /* point 0; shines within the angle around direction whose cosine is
                                * cos_outer, fully within that of cos_inner */
  KIWAMI_LIGHT_TRIANGLE = 2,   /* points 0 to 2; shines to the side of its normal
                                * (p1 - p0) x (p2 - p0), its radiance the same in all directions */
  KIWAMI_LIGHT_QUAD = 3,       /* points 0 to 3 around it, two triangles (0, 1, 2), (0, 2, 3) */
  KIWAMI_LIGHT_SPHERE = 4,     /* point 0 and radius; shines outwards */
  KIWAMI_LIGHT_DISC = 5,       /* point 0 and radius; shines to the side of direction, its normal */
  KIWAMI_LIGHT_DISTANT = 6,    /* its light travels along direction, from within the angle around it
                                * whose cosine is cos_outer (1 for parallel light) */
  KIWAMI_LIGHT_ENVIRONMENT = 7 /* light from all directions */
};

enum {
  /* Triangles, quads and discs: shine to both sides; the power is that of both together. */
  KIWAMI_LIGHT_TWO_SIDED = 1u << 0
};

/* The most choices of a receiver. */
#define KIWAMI_LIGHT_MAX_CHOICES 64

/* A light. What its type does not name is not read. 96 bytes, at any address. */
typedef struct kiwami_light {
  uint32_t type;      /* KIWAMI_LIGHT_* */
  uint32_t flags;     /* KIWAMI_LIGHT_TWO_SIDED */
  float points[12];   /* four points, x, y and z of each: finite, within KIWAMI_MAX_COORDINATE */
  float direction[3]; /* of any length but 0 */
  float radius;       /* above 0, within KIWAMI_MAX_COORDINATE */
  float cos_inner;    /* at least cos_outer, at most 1 */
  float cos_outer;    /* -1 to 1 */
  float power;        /* what it emits in all, of one wavelength or as a luminance, 0 or more: only
                       * ratios count. A light of power 0 is never chosen. Of distant lights and
                       * environments: compared among each other alone. */
  uint32_t user_id;   /* the caller's own; copied to the choices */
  uint64_t link_mask; /* lights a receiver only if (link_mask & receiver.link_mask) != 0 */
} kiwami_light;

/* Emissive triangles: each becomes a light as KIWAMI_LIGHT_TRIANGLE. A triangle without area, or
 * with a vertex that is not finite or beyond KIWAMI_MAX_COORDINATE, has power 0. */
typedef struct kiwami_light_mesh_desc {
  uint32_t struct_size;     /* bytes of this struct, set by kiwami_light_mesh_desc_init */
  uint32_t flags;           /* KIWAMI_LIGHT_TWO_SIDED */
  const void* vertices;     /* three floats a vertex, at any address; read during the call only */
  uint64_t vertex_stride;   /* bytes from one vertex to the next, at least 12; 0: 12 */
  uint64_t vertex_count;    /* at most 2^32 - 1 */
  const void* indices;      /* three uint32 a triangle, each below vertex_count; NULL: triangle i is
                             * made of the vertices 3i, 3i + 1, 3i + 2 */
  uint64_t index_stride;    /* bytes from one triangle to the next, at least 12; 0: 12 */
  uint64_t triangle_count;  /* at most 2^26 */
  const void* radiances;    /* one float a triangle, its mean radiance, 0 or more; NULL: radiance */
  uint64_t radiance_stride; /* bytes from one to the next, at least 4; 0: 4 */
  uint64_t link_mask;       /* as in kiwami_light; all ones */
  float radiance;        /* of every triangle where radiances is NULL; 1. A triangle's power is pi
                          * times area times radiance, twice that if two-sided. */
  uint32_t user_id;      /* of triangle 0 */
  uint32_t user_id_step; /* triangle i has user_id + i * user_id_step */
  uint32_t reserved;     /* 0 */
} kiwami_light_mesh_desc;

/* A committed tree seen through a transform: a group of lights that moves, or is there repeatedly.
 * Everything of a light is transformed: a spot shines where the transform maps its cone to. */
typedef struct kiwami_light_instance_desc {
  uint32_t struct_size;     /* bytes of this struct, set by kiwami_light_instance_desc_init */
  float power_scale;        /* multiplies the power of its lights, 0 or more; 1. Triangles whose
                             * radiance stays as it is gain power as the transform gains area. */
  kiwami_light_tree* tree;  /* of the same device and width, committed, without instances, distant
                             * lights and environments of its own. It is shown as it is when the
                             * instance is added or set. */
  float local_to_world[12]; /* three rows of four: world = row . (x, y, z, 1); invertible */
  uint64_t link_mask;       /* a receiver must share a bit with it and, among these, with the light;
                             * all ones */
} kiwami_light_instance_desc;

enum {
  /* Surface area orientation heuristic: lights are grouped by place, direction and power. */
  KIWAMI_LIGHT_BUILDER_SAOH = 0,
  /* Grouped by the octant of their direction at the root, below by place and power. */
  KIWAMI_LIGHT_BUILDER_OCTANTS = 1
};

enum {
  /* Build what the methods CULLING, ROULETTE and LAZY_ROULETTE need, too: 100 to 200 bytes more for
   * each light. */
  KIWAMI_LIGHT_TREE_WITH_ROULETTE = 1u << 0
};

/* How a set of lights is made. */
typedef struct kiwami_light_tree_desc {
  uint32_t struct_size;      /* bytes of this struct, set by kiwami_light_tree_desc_init */
  uint32_t width;            /* children of a node, among which one is chosen: 2, 4, 8 or 16; 0: the
                              * device's default */
  uint32_t builder;          /* KIWAMI_LIGHT_BUILDER_* */
  float distant_probability; /* with which distant lights and environments are chosen from where
                              * others can contribute, too: above 0, below 1. 0: n / (n + 1) for n
                              * of them. */
  uint32_t flags;            /* KIWAMI_LIGHT_TREE_* */
  uint32_t reserved;         /* 0 */
} kiwami_light_tree_desc;

/* The numbers of a committed set of lights. */
typedef struct kiwami_light_tree_info {
  uint32_t struct_size;    /* set by the caller to sizeof(kiwami_light_tree_info) */
  uint32_t width;          /* the most children of a node */
  uint32_t light_count;    /* lights added, the triangles of meshes among them */
  uint32_t instance_count; /* instances added */
  uint32_t distant_count;  /* distant lights and environments among the lights */
  uint32_t node_count;     /* nodes of the tree */
  uint32_t depth;          /* nodes on the longest path from the root to a light */
  uint32_t reserved;       /* 0 */
  uint64_t bytes;       /* memory of the handle and what it committed, without instances' trees */
  double power;         /* of all lights in the tree, instances included */
  double cost;          /* of the tree by the surface area orientation heuristic: the sum over
                         * nodes of power times area measure times orientation measure, relative
                         * to the root's */
  double build_seconds; /* wall-clock time of the last commit or refit */
} kiwami_light_tree_info;

enum {
  /* The receiver takes light from both sides of its normal. */
  KIWAMI_RECEIVER_BOTH_SIDES = 1u << 0
};

/* Who asks for a light: a point with a normal, a point without (in a volume), or a segment (a ray
 * through a volume). 56 bytes, at any address. A position, normal or segment that is not finite, or
 * a position (end of the segment) beyond KIWAMI_MAX_COORDINATE, gets no light. */
typedef struct kiwami_light_receiver {
  float position[3];
  float normal[3];    /* of any length; 0, 0, 0: none. Not read with a segment. */
  float segment[3];   /* from position to the other end; 0, 0, 0: a point */
  uint32_t flags;     /* KIWAMI_RECEIVER_* */
  uint64_t link_mask; /* see kiwami_light; all ones for every light */
  double random;      /* at least 0, below 1. Probabilities below its resolution are lost: give it
                       * more than the 24 bits of a float where there are many lights. */
} kiwami_light_receiver;

/* A light that was chosen. 24 bytes, at any address. */
typedef struct kiwami_light_choice {
  uint32_t light_id;    /* its number in its tree; KIWAMI_INVALID_ID: none */
  uint32_t instance_id; /* the instance through which it is seen; KIWAMI_INVALID_ID: none */
  uint32_t user_id;     /* that of the light */
  float probability;    /* with which this choice was made, above 0; 0 for none */
  double random;        /* a new random number, at least 0 and below 1, for a point on the light */
} kiwami_light_choice;

/* Names a light: light_id and instance_id as in kiwami_light_choice. 8 bytes, at any address. */
typedef struct kiwami_light_name {
  uint32_t light_id;
  uint32_t instance_id;
} kiwami_light_name;

enum {
  /* Down the tree, one child of a node at a time: one choice (Conty Estevez & Kulla 2018). */
  KIWAMI_LIGHT_METHOD_TREE = 0,
  /* By power alone, whatever the receiver is: one choice. To compare with. */
  KIWAMI_LIGHT_METHOD_POWER = 1,
  /* Down the tree, taking all children of a node in place of one where its lights are likely to
   * contribute differently: up to max_choices choices, each light at most once. The estimate is the
   * sum over the choices of contribution / probability. */
  KIWAMI_LIGHT_METHOD_TREE_SPLITTING = 2,
  /* Stochastic lightcuts: the cluster that can contribute most is opened, until there are
   * max_choices of them (or all are lights), and of each one light is chosen. */
  KIWAMI_LIGHT_METHOD_LIGHTCUTS = 3,
  /* Hierarchical Russian roulette, the lazy variant: each light is accepted or not for itself, in
   * proportion to its energy and the cosine at the receiver over the squared distance, capped at 1.
   * About half of max_choices are accepted; there may be none. Where more than max_choices are
   * accepted, that many of them are kept, with probabilities that are less in proportion (so the
   * estimate stays unbiased), while kiwami_light_pdf gives that of being accepted. Of an instance
   * that is accepted, one light is chosen by power. */
  KIWAMI_LIGHT_METHOD_LAZY_ROULETTE = 4,
  /* Stochastic light culling: each light is accepted where the receiver is within its range, which
   * depends on the light's energy and on a random number of its own, not on the receiver. Receivers
   * that are given the same random number see the same ranges. Which lights there is room for, and
   * instances, are as with LAZY_ROULETTE. */
  KIWAMI_LIGHT_METHOD_CULLING = 5,
  /* Hierarchical Russian roulette as it was published: as LAZY_ROULETTE, but each light's number is
   * independent of all others. */
  KIWAMI_LIGHT_METHOD_ROULETTE = 6
};

/* What of the receiver counts, in proportion to which ROULETTE and LAZY_ROULETTE accept a light, and
 * TREE, TREE_SPLITTING and LIGHTCUTS choose: beside energy and squared distance, of directions from
 * the receiver to the light (to the lights of a node), the greatest of: */
enum {
  /* The cosine at the receiver (Dachsbacher's lobe). */
  KIWAMI_LIGHT_LOBE_COSINE = 0,
  /* The square of that cosine: lights within a sphere that touches the tangent plane. Of the
   * roulettes; as COSINE with others. */
  KIWAMI_LIGHT_LOBE_TANGENT_SPHERE = 1,
  /* A squared ellipsoidal lobe around the receiver's mirror direction, for what is glossy: lights
   * are chosen by what the receiver reflects of them. No light above the tangent plane has a
   * probability of 0. Of receivers that are diffuse, too, let some of the choices be made with
   * COSINE, and weigh both by their probabilities (kiwami_light_pdf; E. Veach's balance
   * heuristic). */
  KIWAMI_LIGHT_LOBE_GLOSSY = 2
};

/* How LAZY_ROULETTE gives the lights their numbers. */
enum {
  KIWAMI_LIGHT_ORDER_XOR = 0,      /* the light's place in the tree, xor one random number */
  KIWAMI_LIGHT_ORDER_SCRAMBLED = 1 /* the halves of every subtree are exchanged at random (Owen) */
};

/* The lobe of a glossy receiver. 16 bytes, at any address. */
typedef struct kiwami_light_lobe {
  float axis[3];   /* away from the receiver, of any length, where the lobe has its peak: the mirror
                    * direction. Not finite or of length 0: the receiver has the lobe COSINE, as
                    * all segments have. */
  float roughness; /* GGX's alpha; less than 0.001 counts as that, more than 1 as 1 */
} kiwami_light_lobe;

/* Where the numbers come from that ROULETTE and LAZY_ROULETTE compare with. */
enum {
  /* The receiver's random number. */
  KIWAMI_LIGHT_SEQUENCE_RANDOM = 0,
  /* Of each number of a pixel a low-discrepancy sequence over its samples, shifted by blue noise over
   * the pixels: errors of neighbours differ, so that pictures look and filter better with as much
   * error in all. What is not compared (which of several that were accepted stay, and the choices'
   * new random numbers) comes from the receiver's random number all the same. */
  KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE = 1
};

/* A sample of a pixel. 12 bytes, at any address. */
typedef struct kiwami_light_pixel {
  uint32_t x, y;
  uint32_t sample; /* its number among those of the pixel, counted from any number */
} kiwami_light_pixel;

enum {
  /* Sample on the calling thread alone, however many receivers there are. */
  KIWAMI_LIGHT_QUERY_CALLING_THREAD = 1u << 0
};

/* How lights are chosen. */
typedef struct kiwami_light_query {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_light_query_init */
  uint32_t flags;       /* KIWAMI_LIGHT_QUERY_* */
  uint32_t method;      /* KIWAMI_LIGHT_METHOD_* */
  uint32_t max_choices; /* the choices that a receiver gets at most, and has room for; 1 (the
                         * default), or with all methods but TREE and POWER up to
                         * KIWAMI_LIGHT_MAX_CHOICES */
  float threshold;      /* of TREE_SPLITTING, 0 to 1: 0 splits nothing, 1 splits all that there is
                         * room for; 0.5 */
  uint32_t lobe;        /* KIWAMI_LIGHT_LOBE_*; of POWER and CULLING not read */
  uint32_t order;       /* of LAZY_ROULETTE: KIWAMI_LIGHT_ORDER_* */
  float reach; /* of CULLING, 0 or more: at this distance of a receiver from all lights half
                * of max_choices are accepted. 0: the radius of all lights' box over the
                * root of 3 */
  const kiwami_light_lobe* lobes; /* of the lobe GLOSSY, one a receiver; read during the call only;
                                   * NULL only with other lobes */
  uint64_t lobe_stride;           /* bytes from one to the next, at least 16; 0: 16 */
  uint32_t sequence;              /* of ROULETTE and LAZY_ROULETTE: KIWAMI_LIGHT_SEQUENCE_* */
  uint32_t sequence_seed;         /* of BLUE_NOISE: another seed, other numbers. Over all seeds each
                                   * number is uniform, so estimates are unbiased. */
  const kiwami_light_pixel* pixels; /* of the sequence BLUE_NOISE, one a receiver; read during the
                                     * call only; NULL only with others. kiwami_light_pdf does not
                                     * read it. */
  uint64_t pixel_stride;            /* bytes from one to the next, at least 12; 0: 12 */
} kiwami_light_query;

/* Fill a struct with its defaults: see the fields; a transform that changes nothing, no
 * vertices, the method TREE.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: the pointer is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_desc_init(kiwami_light_tree_desc* desc, size_t size);
KIWAMI_API kiwami_result kiwami_light_mesh_desc_init(kiwami_light_mesh_desc* desc, size_t size);
KIWAMI_API kiwami_result kiwami_light_instance_desc_init(kiwami_light_instance_desc* desc,
                                                         size_t size);
KIWAMI_API kiwami_result kiwami_light_query_init(kiwami_light_query* query, size_t size);

/* Makes a set of no lights, which is not committed.
 *   desc      NULL for the defaults
 *   tree      receives the handle, with one reference, or NULL on error
 *   errors    INVALID_ARGUMENT: NULL, a field of desc; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_create(kiwami_device* device,
                                                  const kiwami_light_tree_desc* desc,
                                                  kiwami_light_tree** tree);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_light_tree_retain(kiwami_light_tree* tree);

/* Drops a reference; the last one ends the set. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_light_tree_release(kiwami_light_tree* tree);

/* Adds lights. They are numbered in the order in which they are added, triangles of meshes, too.
 *   lights    count lights, stride bytes apart (0: sizeof(kiwami_light)); NULL only if count is 0
 *   first_id  receives the number of the first; may be NULL
 *   errors    INVALID_ARGUMENT: NULL, a stride too small, an unknown type or flag, a field that is
 *             not as kiwami_light says, a triangle, quad without area (then none was added);
 *             TOO_LARGE: more than 2^26 lights; OUT_OF_MEMORY
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_add_lights(kiwami_light_tree* tree,
                                                      const kiwami_light* lights, size_t stride,
                                                      size_t count, uint32_t* first_id);

/* Adds the triangles of a mesh, as many lights.
 *   first_id  receives the number of triangle 0; may be NULL
 *   errors    INVALID_ARGUMENT: NULL, a field of desc, an index at or beyond vertex_count, a
 *             radiance that is negative or not finite (then none was added); TOO_LARGE: more than
 *             2^26 lights; OUT_OF_MEMORY
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_add_mesh(kiwami_light_tree* tree,
                                                    const kiwami_light_mesh_desc* desc,
                                                    uint32_t* first_id);

/* Adds an instance of another set's tree.
 *   instance_id  receives its number, counted from 0; may be NULL
 *   errors       INVALID_ARGUMENT: NULL, a field of desc; TOO_LARGE: more than 2^20 instances;
 *                OUT_OF_MEMORY
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_add_instance(kiwami_light_tree* tree,
                                                        const kiwami_light_instance_desc* desc,
                                                        uint32_t* instance_id);

/* Replaces lights, which keep their numbers.
 *   first     the number of the first
 *   errors    as kiwami_light_tree_add_lights; INVALID_ARGUMENT also: lights that were not added
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_set_lights(kiwami_light_tree* tree, uint32_t first,
                                                      const kiwami_light* lights, size_t stride,
                                                      size_t count);

/* Gives lights another power.
 *   first     the number of the first
 *   powers    count floats, stride bytes apart (0: 4); NULL only if count is 0
 *   errors    INVALID_ARGUMENT: NULL, lights that were not added, a stride too small, a power that
 *             is negative or not finite (then none was changed)
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_set_powers(kiwami_light_tree* tree, uint32_t first,
                                                      const float* powers, size_t stride,
                                                      size_t count);

/* Replaces an instance: its transform, power, or tree.
 *   errors    as kiwami_light_tree_add_instance; INVALID_ARGUMENT also: no such instance
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_set_instance(kiwami_light_tree* tree,
                                                        uint32_t instance_id,
                                                        const kiwami_light_instance_desc* desc);

/* Builds the tree over all lights, on the device's threads. On error what was committed before
 * stays.
 *   errors    INVALID_ARGUMENT: tree is NULL; OUT_OF_MEMORY; CALLBACK: the runner failed
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_commit(kiwami_light_tree* tree);

/* Brings the committed tree up to date after lights and instances were set, keeping its shape:
 * fast, at the price of a tree that fits less and less. What it costs says
 * kiwami_light_tree_get_info.
 *   errors    INVALID_ARGUMENT: tree is NULL; INVALID_STATE: never committed, lights or instances
 *             added since, or a light became distant (or an environment) or ceased to be;
 *             OUT_OF_MEMORY
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_refit(kiwami_light_tree* tree);

/* Says what was committed.
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: tree or info is NULL, or struct_size is below 8; INVALID_STATE:
 *             never committed
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_tree_get_info(const kiwami_light_tree* tree,
                                                    kiwami_light_tree_info* info);

/* Lets each receiver choose a light, in proportion to what the nodes of the tree and the lights can
 * contribute (method TREE). The probabilities of all lights sum to 1, or to 0 where none can
 * contribute.
 *   receivers  count receivers, receiver_stride bytes apart (0: sizeof(kiwami_light_receiver));
 *              NULL only if count is 0
 *   choices    receives count * max_choices choices, choice_stride bytes apart (0:
 *              sizeof(kiwami_light_choice)): those of receiver i are i * max_choices on, first the
 *              ones that were made. May not overlap the receivers.
 *   query      NULL for the defaults
 * Large batches run on the device's threads. Nothing is allocated.
 *   errors     INVALID_ARGUMENT: tree is NULL, a field of query; INVALID_STATE: never committed, or
 *              CULLING, ROULETTE or LAZY_ROULETTE of a set without
 *              KIWAMI_LIGHT_TREE_WITH_ROULETTE;
 *              CALLBACK: the runner failed. With KIWAMI_DEVICE_VALIDATE also INVALID_ARGUMENT:
 *              NULL, a stride too small, an extent that overflows
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_sample(const kiwami_light_tree* tree,
                                             const kiwami_light_receiver* receivers,
                                             size_t receiver_stride, kiwami_light_choice* choices,
                                             size_t choice_stride, size_t count,
                                             const kiwami_light_query* query);

/* The probability with which a light is among the choices of each receiver: to the bit that of
 * kiwami_light_sample, by the same query, where it is.
 *   receivers      as in kiwami_light_sample; their random numbers are not read
 *   lights         count names, light_stride bytes apart (0: sizeof(kiwami_light_name)). A name of
 *                  no light has probability 0.
 *   probabilities  receives count floats, probability_stride bytes apart (0: 4)
 * Otherwise as kiwami_light_sample. [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_light_pdf(const kiwami_light_tree* tree,
                                          const kiwami_light_receiver* receivers,
                                          size_t receiver_stride, const kiwami_light_name* lights,
                                          size_t light_stride, float* probabilities,
                                          size_t probability_stride, size_t count,
                                          const kiwami_light_query* query);

#ifdef __cplusplus
}
#endif

#endif
