/* SPDX-License-Identifier: Apache-2.0
 *
 * Sets of lights, points, and the lights that these choose. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "record.h"

enum { kLightCount = 40, kMeshTriangles = 24, kReceiverCount = 96 };

static void random_floats(float* values, int count) {
  for (int i = 0; i < count; ++i) values[i] = random_number();
}

/* One of each kind, and then those that have a place, in turn. */
static void make_lights(kiwami_light* lights) {
  memset(lights, 0, kLightCount * sizeof(*lights));
  for (uint32_t i = 0; i < kLightCount; ++i) {
    kiwami_light* const light = &lights[i];
    /* Two that are far away; more of them would leave little to the tree. */
    const uint32_t type = i < 8 ? i : i % KIWAMI_LIGHT_DISTANT;
    const int has_sides =
        type == KIWAMI_LIGHT_TRIANGLE || type == KIWAMI_LIGHT_QUAD || type == KIWAMI_LIGHT_DISC;
    light->type = type;
    light->flags = has_sides && i % 16 >= 8 ? KIWAMI_LIGHT_TWO_SIDED : 0u;
    random_floats(light->points, 12);
    random_floats(light->direction, 3);
    light->radius = (float)(1 + random_bits() % 8) / 16.0f;
    light->cos_inner = 1.0f;
    light->cos_outer = type == KIWAMI_LIGHT_DISTANT ? 1.0f : 0.5f;
    light->power = (float)(random_bits() % 64) / 16.0f;
    light->user_id = 1000 + i;
    light->link_mask = i % 7 == 6 ? 2u : ~(uint64_t)0;
  }
}

/* Points with a normal, points without, and segments. */
static void make_receivers(kiwami_light_receiver* receivers) {
  memset(receivers, 0, kReceiverCount * sizeof(*receivers));
  for (uint32_t i = 0; i < kReceiverCount; ++i) {
    kiwami_light_receiver* const receiver = &receivers[i];
    random_floats(receiver->position, 3);
    if (i % 4 != 1) random_floats(receiver->normal, 3);
    if (i % 4 == 3) random_floats(receiver->segment, 3);
    receiver->flags = i % 8 == 4 ? KIWAMI_RECEIVER_BOTH_SIDES : 0u;
    receiver->link_mask = i % 5 == 2 ? 1u : ~(uint64_t)0;
    receiver->random = (double)random_bits() / 4294967296.0;
  }
  receivers[10].position[0] = 1e30f; /* beyond KIWAMI_MAX_COORDINATE: no light */
}

static void record_lights(kiwami_light_tree* tree, const kiwami_light* lights) {
  printf("light %d\n", kLightCount);
  print_words(lights, kLightCount, sizeof(*lights) / sizeof(uint32_t));
  require(kiwami_light_tree_add_lights(tree, lights, 0, kLightCount, NULL), "lights");
}

static void record_light_mesh(kiwami_light_tree* tree, const mesh* made, int is_two_sided) {
  kiwami_light_mesh_desc desc;
  printf("light_mesh %d %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", is_two_sided, bits_of(0.75f),
         made->vertex_count, made->triangle_count);
  print_words(made->vertices, made->vertex_count, 3);
  print_words(made->triangles, made->triangle_count, 3);
  require(kiwami_light_mesh_desc_init(&desc, sizeof(desc)), "light mesh");
  desc.flags = is_two_sided ? KIWAMI_LIGHT_TWO_SIDED : 0u;
  desc.vertices = made->vertices;
  desc.vertex_count = made->vertex_count;
  desc.indices = made->triangles;
  desc.triangle_count = made->triangle_count;
  desc.radiance = 0.75f;
  require(kiwami_light_tree_add_mesh(tree, &desc, NULL), "light mesh");
}

static void record_powers(kiwami_light_tree* tree) {
  float powers[8];
  for (int i = 0; i < 8; ++i) powers[i] = (float)(random_bits() % 64) / 8.0f;
  printf("powers 3 8\n");
  print_words(powers, 8, 1);
  require(kiwami_light_tree_set_powers(tree, 3, powers, 0, 8), "powers");
}

static void record_choices(kiwami_light_tree* tree, const kiwami_light_receiver* receivers) {
  kiwami_light_choice choices[kReceiverCount];
  float probabilities[kReceiverCount];
  printf("receivers %d\n", kReceiverCount);
  print_words(receivers, kReceiverCount, sizeof(*receivers) / sizeof(uint32_t));
  require(kiwami_light_sample(tree, receivers, 0, choices, 0, kReceiverCount, NULL), "sample");
  printf("choices\n");
  print_words(choices, kReceiverCount, sizeof(*choices) / sizeof(uint32_t));
  require(kiwami_light_pdf(tree, receivers, 0, (const kiwami_light_name*)choices, sizeof(*choices),
                           probabilities, 0, kReceiverCount, NULL),
          "pdf");
  printf("pdf\n");
  print_words(probabilities, kReceiverCount, 1);
}

void print_lights(kiwami_device* device) {
  static mesh shining;
  static kiwami_light lights[kLightCount];
  static kiwami_light_receiver receivers[kReceiverCount];
  make_lights(lights);
  make_soup(&shining, kMeshTriangles, ~0u);
  make_receivers(receivers);
  for (uint32_t width = 4; width <= 8; width *= 2) {
    kiwami_light_tree_desc desc;
    kiwami_light_tree* tree;
    printf("lights %" PRIu32 "\n", width);
    require(kiwami_light_tree_desc_init(&desc, sizeof(desc)), "light tree");
    desc.width = width;
    require(kiwami_light_tree_create(device, &desc, &tree), "light tree");
    record_lights(tree, lights);
    record_light_mesh(tree, &shining, width == 8);
    printf("commit\n");
    require(kiwami_light_tree_commit(tree), "commit");
    record_choices(tree, receivers);
    record_powers(tree);
    printf("refit\n");
    require(kiwami_light_tree_refit(tree), "refit");
    record_choices(tree, receivers);
    printf("end\n");
    kiwami_light_tree_release(tree);
  }
}
