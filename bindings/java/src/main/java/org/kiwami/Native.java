// SPDX-License-Identifier: Apache-2.0
// The C interface for JNA. Generated from the headers by
// bindings/schema/generate.py; do not edit.
package org.kiwami;

import com.sun.jna.Callback;
import com.sun.jna.Pointer;

final class Native {
  private Native() {}

  static final int KIWAMI_ABI_VERSION = 0;
  static final int KIWAMI_FILE_FORMAT_VERSION = 2;
  static final int KIWAMI_INVALID_ID = 0xffffffff;
  static final int KIWAMI_LIGHT_MAX_CHOICES = 64;
  static final float KIWAMI_MAX_COORDINATE = 1.152921504606847e+18f;
  static final int KIWAMI_MAX_INSTANCE_DEPTH = 8;
  static final int KIWAMI_OPACITY_ALL_OPAQUE = 0xfffffffd;
  static final int KIWAMI_OPACITY_ALL_TRANSPARENT = 0xfffffffc;
  static final int KIWAMI_OPACITY_ALL_UNKNOWN_OPAQUE = 0xffffffff;
  static final int KIWAMI_OPACITY_ALL_UNKNOWN_TRANSPARENT = 0xfffffffe;
  static final int KIWAMI_VERSION_MAJOR = 0;
  static final int KIWAMI_VERSION_MINOR = 1;
  static final int KIWAMI_VERSION_PATCH = 0;
  static final int KIWAMI_OK = 0;
  static final int KIWAMI_ERROR_INVALID_ARGUMENT = -1;
  static final int KIWAMI_ERROR_INVALID_STATE = -2;
  static final int KIWAMI_ERROR_OUT_OF_MEMORY = -3;
  static final int KIWAMI_ERROR_UNSUPPORTED_ISA = -4;
  static final int KIWAMI_ERROR_TOO_LARGE = -5;
  static final int KIWAMI_ERROR_CALLBACK = -6;
  static final int KIWAMI_ERROR_VALIDATION = -7;
  static final int KIWAMI_ERROR_INTERNAL = -8;
  static final int KIWAMI_ERROR_CAPACITY = -9;
  static final int KIWAMI_ERROR_INVALID_FILE = -10;
  static final int KIWAMI_ERROR_IO = -11;
  static final int KIWAMI_ERROR_CANCELLED = -12;
  static final int KIWAMI_ISA_AUTO = 0;
  static final int KIWAMI_ISA_SCALAR = 1;
  static final int KIWAMI_ISA_SSE = 2;
  static final int KIWAMI_ISA_AVX2 = 3;
  static final int KIWAMI_ISA_AVX512 = 4;
  static final int KIWAMI_DEVICE_VALIDATE = 1;
  static final int KIWAMI_MESH_SHARE_BUFFERS = 1;
  static final int KIWAMI_PARAMETER_BVH_WIDTH = 1;
  static final int KIWAMI_PARAMETER_MERGE_LEAVES = 2;
  static final int KIWAMI_PARAMETER_MERGE_RING = 3;
  static final int KIWAMI_PARAMETER_BIN_COUNT = 4;
  static final int KIWAMI_PARAMETER_MAX_LEAF_SIZE = 5;
  static final int KIWAMI_PARAMETER_NODE_COST = 6;
  static final int KIWAMI_PARAMETER_LEAF_COST = 7;
  static final int KIWAMI_PARAMETER_VALIDATE_BUILD = 8;
  static final int KIWAMI_PARAMETER_CONTRACTION = 9;
  static final int KIWAMI_PARAMETER_BUILDER = 10;
  static final int KIWAMI_PARAMETER_SPLIT_BUDGET = 11;
  static final int KIWAMI_PARAMETER_SPLIT_ALPHA = 12;
  static final int KIWAMI_PARAMETER_BIN_HALVING = 13;
  static final int KIWAMI_PARAMETER_REASSIGN = 14;
  static final int KIWAMI_PARAMETER_AAC_QUALITY = 17;
  static final int KIWAMI_PARAMETER_CURVE_CODE = 18;
  static final int KIWAMI_PARAMETER_LBVH_DELTA = 19;
  static final int KIWAMI_PARAMETER_LBVH_CHUNK_SIZE = 20;
  static final int KIWAMI_PARAMETER_LAYOUT = 21;
  static final int KIWAMI_PARAMETER_QUALITY = 30;
  static final int KIWAMI_PARAMETER_REBRAID = 40;
  static final int KIWAMI_PARAMETER_REBRAID_BUDGET = 41;
  static final int KIWAMI_PARAMETER_TWO_LEVEL = 42;
  static final int KIWAMI_PARAMETER_DIVIDE_TIME = 43;
  static final int KIWAMI_REBRAID_OFF = 0;
  static final int KIWAMI_REBRAID_FULL = 1;
  static final int KIWAMI_REBRAID_ROOTS = 2;
  static final int KIWAMI_LAYOUT_FAST = 0;
  static final int KIWAMI_LAYOUT_COMPACT = 1;
  static final int KIWAMI_STAGE_BUILDER = 1;
  static final int KIWAMI_STAGE_OPTIMIZER = 2;
  static final int KIWAMI_STAGE_CONTRACTION = 3;
  static final int KIWAMI_QUALITY_BALANCED = 0;
  static final int KIWAMI_QUALITY_FAST = 1;
  static final int KIWAMI_QUALITY_BEST = 2;
  static final int KIWAMI_BUILDER_BINNED_SAH = 0;
  static final int KIWAMI_BUILDER_LBVH = 1;
  static final int KIWAMI_BUILDER_PLOC = 2;
  static final int KIWAMI_BUILDER_SWEEP_SAH = 3;
  static final int KIWAMI_BUILDER_SPATIAL_SPLIT = 4;
  static final int KIWAMI_BUILDER_AGGLOMERATIVE = 5;
  static final int KIWAMI_BUILDER_AAC = 6;
  static final int KIWAMI_BUILDER_MINI_TREE = 7;
  static final int KIWAMI_BUILDER_OIBVH = 8;
  static final int KIWAMI_BUILDER_WIDE_BOTTOM_UP = 9;
  static final int KIWAMI_BUILDER_STR = 10;
  static final int KIWAMI_BUILDER_TRBVH = 11;
  static final int KIWAMI_BUILDER_WIDE_TOP_DOWN = 12;
  static final int KIWAMI_BUILDER_WIDE_LINEAR = 13;
  static final int KIWAMI_BUILDER_TRIAL = 14;
  static final int KIWAMI_OPTIMIZER_PARALLEL_REINSERTION = 1;
  static final int KIWAMI_OPTIMIZER_ROTATION = 2;
  static final int KIWAMI_OPTIMIZER_TREELET = 3;
  static final int KIWAMI_OPTIMIZER_AGGLOMERATIVE_TREELET = 4;
  static final int KIWAMI_OPTIMIZER_REINSERTION = 5;
  static final int KIWAMI_OPTIMIZER_REORDER_SATO = 6;
  static final int KIWAMI_OPTIMIZER_REORDER_NARY = 7;
  static final int KIWAMI_CONTRACTION_SURFACE_AREA = 0;
  static final int KIWAMI_CONTRACTION_OPTIMAL = 1;
  static final int KIWAMI_CONTRACTION_RAY_DISTRIBUTION = 2;
  static final int KIWAMI_MAX_OPTIMIZERS = 8;
  static final int KIWAMI_INSTANCES_SHARE_BUFFERS = 1;
  static final int KIWAMI_RAY_CULL_BACK_FACES = 1;
  static final int KIWAMI_RAY_CULL_FRONT_FACES = 2;
  static final int KIWAMI_FILTER_REJECT = 0;
  static final int KIWAMI_FILTER_ACCEPT = 1;
  static final int KIWAMI_FILTER_ACCEPT_AND_STOP = 2;
  static final int KIWAMI_QUERY_CALLING_THREAD = 1;
  static final int KIWAMI_MEASURE_WITHOUT_EPO = 1;
  static final int KIWAMI_COUNT_CLOSEST_HIT = 0;
  static final int KIWAMI_COUNT_ANY_HIT = 1;
  static final int KIWAMI_BINARY_LAYOUT_BOXES = 0;
  static final int KIWAMI_BINARY_LAYOUT_DUAL_SPLIT = 1;
  static final int KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST = 0;
  static final int KIWAMI_DISTRIBUTION_ALIAS_TABLE = 1;
  static final int KIWAMI_EXPORT_BINARY = 1;
  static final int KIWAMI_EXPORT_WIDE4 = 2;
  static final int KIWAMI_EXPORT_WIDE8 = 3;
  static final int KIWAMI_EXPORT_COMPRESSED8 = 4;
  static final int KIWAMI_LIGHT_POINT = 0;
  static final int KIWAMI_LIGHT_SPOT = 1;
  static final int KIWAMI_LIGHT_TRIANGLE = 2;
  static final int KIWAMI_LIGHT_QUAD = 3;
  static final int KIWAMI_LIGHT_SPHERE = 4;
  static final int KIWAMI_LIGHT_DISC = 5;
  static final int KIWAMI_LIGHT_DISTANT = 6;
  static final int KIWAMI_LIGHT_ENVIRONMENT = 7;
  static final int KIWAMI_LIGHT_TWO_SIDED = 1;
  static final int KIWAMI_LIGHT_BUILDER_SAOH = 0;
  static final int KIWAMI_LIGHT_BUILDER_OCTANTS = 1;
  static final int KIWAMI_LIGHT_TREE_WITH_ROULETTE = 1;
  static final int KIWAMI_RECEIVER_BOTH_SIDES = 1;
  static final int KIWAMI_LIGHT_METHOD_TREE = 0;
  static final int KIWAMI_LIGHT_METHOD_POWER = 1;
  static final int KIWAMI_LIGHT_METHOD_TREE_SPLITTING = 2;
  static final int KIWAMI_LIGHT_METHOD_LIGHTCUTS = 3;
  static final int KIWAMI_LIGHT_METHOD_LAZY_ROULETTE = 4;
  static final int KIWAMI_LIGHT_METHOD_CULLING = 5;
  static final int KIWAMI_LIGHT_METHOD_ROULETTE = 6;
  static final int KIWAMI_LIGHT_LOBE_COSINE = 0;
  static final int KIWAMI_LIGHT_LOBE_TANGENT_SPHERE = 1;
  static final int KIWAMI_LIGHT_LOBE_GLOSSY = 2;
  static final int KIWAMI_LIGHT_ORDER_XOR = 0;
  static final int KIWAMI_LIGHT_ORDER_SCRAMBLED = 1;
  static final int KIWAMI_LIGHT_SEQUENCE_RANDOM = 0;
  static final int KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE = 1;
  static final int KIWAMI_LIGHT_QUERY_CALLING_THREAD = 1;
  static final int KIWAMI_LOAD_MAP = 1;
  static final int KIWAMI_LOAD_TRUSTED = 2;
  static final int KIWAMI_FILE_SCENE = 1;
  static final int KIWAMI_FILE_BVH = 2;
  static final int KIWAMI_FILE_LIGHTS = 3;
  static final int KIWAMI_FIT_NATIVE = 0;
  static final int KIWAMI_FIT_SCALAR = 1;
  static final int KIWAMI_FIT_NONE = 2;
  static final int KIWAMI_MOVING_MESH_SHARE_BUFFERS = 1;
  static final int KIWAMI_MAX_TIME_STEPS = 129;
  static final int KIWAMI_TRANSFORM_MATRIX = 0;
  static final int KIWAMI_TRANSFORM_QUATERNION = 1;
  static final int KIWAMI_OPACITY_TRANSPARENT = 0;
  static final int KIWAMI_OPACITY_OPAQUE = 1;
  static final int KIWAMI_OPACITY_UNKNOWN_TRANSPARENT = 2;
  static final int KIWAMI_OPACITY_UNKNOWN_OPAQUE = 3;
  static final int KIWAMI_OPACITY_2_STATES = 1;
  static final int KIWAMI_OPACITY_4_STATES = 2;
  static final int KIWAMI_OPACITY_MAX_LEVEL = 6;
  static final int KIWAMI_SHAPES_SHARE_BUFFERS = 1;
  static final int KIWAMI_TETRAHEDRA_BOXES = 0;
  static final int KIWAMI_TETRAHEDRA_FACES = 1;
  static final int KIWAMI_USER_HITS_PER_PRIMITIVE = 4;

  /** Offsets of kiwami_device_desc. */
  static final class DeviceDesc {
    static final int STRUCT_BYTES = 88;
    static final int STRUCT_SIZE = 0;
    static final int ISA = 4;
    static final int THREAD_COUNT = 8;
    static final int FLAGS = 12;
    static final int RUNNER = 16;
    static final int RUNNER_USER = 24;
    static final int RUNNER_WIDTH = 32;
    static final int RESERVED = 36;
    static final int ALLOCATE = 40;
    static final int DEALLOCATE = 48;
    static final int ALLOCATOR_USER = 56;
    static final int LOG = 64;
    static final int LOG_USER = 72;
    static final int MEMORY_LIMIT = 80;
  }

  /** Offsets of kiwami_device_info. */
  static final class DeviceInfo {
    static final int STRUCT_BYTES = 56;
    static final int STRUCT_SIZE = 0;
    static final int ISA = 4;
    static final int ISA_AVAILABLE = 8;
    static final int ISA_BUILT = 12;
    static final int NATIVE_WIDTHS = 16;
    static final int DEFAULT_BVH_WIDTH = 20;
    static final int THREAD_COUNT = 24;
    static final int RESERVED = 28;
    static final int MEMORY_BYTES = 32;
    static final int MEMORY_PEAK_BYTES = 40;
    static final int MEMORY_LIMIT = 48;
  }

  /** Offsets of kiwami_triangle_mesh_desc. */
  static final class TriangleMeshDesc {
    static final int STRUCT_BYTES = 80;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int VERTICES = 8;
    static final int VERTEX_OFFSET = 16;
    static final int VERTEX_STRIDE = 24;
    static final int VERTEX_COUNT = 32;
    static final int INDICES = 40;
    static final int INDEX_OFFSET = 48;
    static final int INDEX_STRIDE = 56;
    static final int TRIANGLE_COUNT = 64;
    static final int MASK = 72;
    static final int RESERVED = 76;
  }

  /** Offsets of kiwami_scene_info. */
  static final class SceneInfo {
    static final int STRUCT_BYTES = 176;
    static final int STRUCT_SIZE = 0;
    static final int BVH_WIDTH = 4;
    static final int LEAF_WIDTH = 8;
    static final int BVH_DEPTH = 12;
    static final int TRIANGLE_COUNT = 16;
    static final int SKIPPED_COUNT = 24;
    static final int NODE_COUNT = 32;
    static final int LEAF_BLOCK_COUNT = 40;
    static final int NODE_BYTES = 48;
    static final int LEAF_BYTES = 56;
    static final int TOTAL_BYTES = 64;
    static final int PEAK_BUILD_BYTES = 72;
    static final int NODE_FILL = 80;
    static final int LEAF_FILL = 88;
    static final int SAH_COST = 96;
    static final int BUILD_SECONDS = 104;
    static final int BOUNDS_MIN = 112;
    static final int BOUNDS_MAX = 124;
    static final int REFERENCE_COUNT = 136;
    static final int REFIT_COUNT = 144;
    static final int INSTANCE_COUNT = 152;
    static final int INSTANCE_TREE_BYTES = 160;
    static final int INSTANCE_DEPTH = 168;
    static final int RESERVED = 172;
  }

  /** Offsets of kiwami_instances_desc. */
  static final class InstancesDesc {
    static final int STRUCT_BYTES = 88;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int SCENES = 8;
    static final int SCENE_COUNT = 16;
    static final int SCENE_INDICES = 24;
    static final int SCENE_INDEX_STRIDE = 32;
    static final int TRANSFORMS = 40;
    static final int TRANSFORM_STRIDE = 48;
    static final int COUNT = 56;
    static final int MASKS = 64;
    static final int MASK_STRIDE = 72;
    static final int MASK = 80;
    static final int RESERVED = 84;
  }

  /** Offsets of kiwami_ray. */
  static final class Ray {
    static final int STRUCT_BYTES = 48;
    static final int ORIGIN_X = 0;
    static final int ORIGIN_Y = 4;
    static final int ORIGIN_Z = 8;
    static final int TMIN = 12;
    static final int DIRECTION_X = 16;
    static final int DIRECTION_Y = 20;
    static final int DIRECTION_Z = 24;
    static final int TMAX = 28;
    static final int TIME = 32;
    static final int MASK = 36;
    static final int FLAGS = 40;
    static final int ID = 44;
  }

  /** Offsets of kiwami_hit. */
  static final class Hit {
    static final int STRUCT_BYTES = 36;
    static final int T = 0;
    static final int U = 4;
    static final int V = 8;
    static final int NORMAL_X = 12;
    static final int NORMAL_Y = 16;
    static final int NORMAL_Z = 20;
    static final int PRIMITIVE_ID = 24;
    static final int GEOMETRY_ID = 28;
    static final int INSTANCE_ID = 32;
  }

  /** Offsets of kiwami_input_field. */
  static final class InputField {
    static final int STRUCT_BYTES = 16;
    static final int DATA = 0;
    static final int STRIDE = 8;
  }

  /** Offsets of kiwami_output_field. */
  static final class OutputField {
    static final int STRUCT_BYTES = 16;
    static final int DATA = 0;
    static final int STRIDE = 8;
  }

  /** Offsets of kiwami_ray_fields. */
  static final class RayFields {
    static final int STRUCT_BYTES = 184;
    static final int STRUCT_SIZE = 0;
    static final int RESERVED = 4;
    static final int ORIGIN_X = 8;
    static final int ORIGIN_Y = 24;
    static final int ORIGIN_Z = 40;
    static final int DIRECTION_X = 56;
    static final int DIRECTION_Y = 72;
    static final int DIRECTION_Z = 88;
    static final int TMIN = 104;
    static final int TMAX = 120;
    static final int TIME = 136;
    static final int MASK = 152;
    static final int FLAGS = 168;
  }

  /** Offsets of kiwami_hit_fields. */
  static final class HitFields {
    static final int STRUCT_BYTES = 152;
    static final int STRUCT_SIZE = 0;
    static final int RESERVED = 4;
    static final int T = 8;
    static final int U = 24;
    static final int V = 40;
    static final int NORMAL_X = 56;
    static final int NORMAL_Y = 72;
    static final int NORMAL_Z = 88;
    static final int PRIMITIVE_ID = 104;
    static final int GEOMETRY_ID = 120;
    static final int INSTANCE_ID = 136;
  }

  /** Offsets of kiwami_exclusion. */
  static final class Exclusion {
    static final int STRUCT_BYTES = 12;
    static final int PRIMITIVE_ID = 0;
    static final int GEOMETRY_ID = 4;
    static final int INSTANCE_ID = 8;
  }

  /** Offsets of kiwami_filter_candidate. */
  static final class FilterCandidate {
    static final int STRUCT_BYTES = 88;
    static final int STRUCT_SIZE = 0;
    static final int DEPTH = 4;
    static final int RAY = 8;
    static final int HIT = 16;
    static final int RESERVED = 52;
    static final int INSTANCE_PATH = 56;
  }

  /** Offsets of kiwami_query. */
  static final class Query {
    static final int STRUCT_BYTES = 72;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int INSTANCE_PATHS = 8;
    static final int INSTANCE_PATH_STRIDE = 16;
    static final int EXCLUSIONS = 24;
    static final int EXCLUSION_STRIDE = 32;
    static final int EXCLUSION_PATHS = 40;
    static final int EXCLUSION_PATH_STRIDE = 48;
    static final int FILTER = 56;
    static final int FILTER_USER = 64;
  }

  /** Offsets of kiwami_bvh_node. */
  static final class BvhNode {
    static final int STRUCT_BYTES = 56;
    static final int LOWER = 0;
    static final int UPPER = 12;
    static final int PARENT = 24;
    static final int DEPTH = 28;
    static final int FIRST_CHILD = 32;
    static final int CHILD_COUNT = 36;
    static final int FIRST_PRIMITIVE = 40;
    static final int PRIMITIVE_COUNT = 44;
    static final int STORAGE_INDEX = 48;
    static final int STORAGE_MASK = 52;
  }

  /** Offsets of kiwami_bvh_primitive. */
  static final class BvhPrimitive {
    static final int STRUCT_BYTES = 8;
    static final int GEOMETRY_ID = 0;
    static final int PRIMITIVE_ID = 4;
  }

  /** Offsets of kiwami_bvh_info. */
  static final class BvhInfo {
    static final int STRUCT_BYTES = 56;
    static final int STRUCT_SIZE = 0;
    static final int WIDTH = 4;
    static final int LEAF_WIDTH = 8;
    static final int DEPTH = 12;
    static final int NODE_COUNT = 16;
    static final int LEAF_COUNT = 20;
    static final int PRIMITIVE_COUNT = 24;
    static final int RESERVED = 28;
    static final int BYTES = 32;
    static final int SKIPPED_COUNT = 40;
    static final int BUILD_SECONDS = 48;
  }

  /** Offsets of kiwami_parameter_value. */
  static final class ParameterValue {
    static final int STRUCT_BYTES = 16;
    static final int PARAMETER = 0;
    static final int RESERVED = 4;
    static final int VALUE = 8;
  }

  /** Offsets of kiwami_bvh_desc. */
  static final class BvhDesc {
    static final int STRUCT_BYTES = 72;
    static final int STRUCT_SIZE = 0;
    static final int WIDTH = 4;
    static final int BOXES = 8;
    static final int BOX_STRIDE = 16;
    static final int BOX_COUNT = 24;
    static final int GEOMETRY = 32;
    static final int PARAMETERS = 40;
    static final int PARAMETER_COUNT = 48;
    static final int OPTIMIZERS = 56;
    static final int OPTIMIZER_COUNT = 64;
  }

  /** Offsets of kiwami_bvh_measure_desc. */
  static final class BvhMeasureDesc {
    static final int STRUCT_BYTES = 32;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int NODE_COST = 8;
    static final int LEAF_COST = 16;
    static final int BLOCK_SIZE = 24;
    static final int RESERVED = 28;
  }

  /** Offsets of kiwami_bvh_measures. */
  static final class BvhMeasures {
    static final int STRUCT_BYTES = 48;
    static final int STRUCT_SIZE = 0;
    static final int RESERVED = 4;
    static final int SAH = 8;
    static final int EPO = 16;
    static final int NODE_AREA = 24;
    static final int LEAF_AREA = 32;
    static final int SURFACE_AREA = 40;
  }

  /** Offsets of kiwami_bvh_node_measures. */
  static final class BvhNodeMeasures {
    static final int STRUCT_BYTES = 24;
    static final int AREA = 0;
    static final int SAH = 8;
    static final int EPO = 16;
  }

  /** Offsets of kiwami_visits. */
  static final class Visits {
    static final int STRUCT_BYTES = 48;
    static final int STRUCT_SIZE = 0;
    static final int RESERVED = 4;
    static final int RAY_COUNT = 8;
    static final int HIT_COUNT = 16;
    static final int NODE_VISITS = 24;
    static final int LEAF_VISITS = 32;
    static final int LEAF_COUNT_VARIABILITY = 40;
  }

  /** Offsets of kiwami_ray_visits. */
  static final class RayVisits {
    static final int STRUCT_BYTES = 8;
    static final int NODE_VISITS = 0;
    static final int LEAF_VISITS = 4;
  }

  /** Offsets of kiwami_binary_tree_info. */
  static final class BinaryTreeInfo {
    static final int STRUCT_BYTES = 64;
    static final int STRUCT_SIZE = 0;
    static final int LAYOUT = 4;
    static final int NODE_COUNT = 8;
    static final int SPLIT_COUNT = 16;
    static final int CARVE_COUNT = 24;
    static final int LEAF_COUNT = 32;
    static final int PRIMITIVE_COUNT = 40;
    static final int NODE_BYTES = 48;
    static final int BYTES = 56;
  }

  /** Offsets of kiwami_binary_visits. */
  static final class BinaryVisits {
    static final int STRUCT_BYTES = 32;
    static final int STRUCT_SIZE = 0;
    static final int RESERVED = 4;
    static final int NODE_VISITS = 8;
    static final int PLANE_TESTS = 16;
    static final int LEAF_VISITS = 24;
  }

  /** Offsets of kiwami_distribution_desc. */
  static final class DistributionDesc {
    static final int STRUCT_BYTES = 32;
    static final int STRUCT_SIZE = 0;
    static final int METHOD = 4;
    static final int WEIGHTS = 8;
    static final int WEIGHT_STRIDE = 16;
    static final int WEIGHT_COUNT = 24;
  }

  /** Offsets of kiwami_distribution_info. */
  static final class DistributionInfo {
    static final int STRUCT_BYTES = 48;
    static final int STRUCT_SIZE = 0;
    static final int METHOD = 4;
    static final int WEIGHT_COUNT = 8;
    static final int BYTES = 16;
    static final int TOTAL = 24;
    static final int MEAN_STEPS = 32;
    static final int MOST_STEPS = 40;
    static final int RESERVED = 44;
  }

  /** Offsets of kiwami_draw. */
  static final class Draw {
    static final int STRUCT_BYTES = 16;
    static final int INDEX = 0;
    static final int PROBABILITY = 4;
    static final int RANDOM = 8;
  }

  /** Offsets of kiwami_binary_node. */
  static final class BinaryNode {
    static final int STRUCT_BYTES = 32;
    static final int LOWER = 0;
    static final int FIRST = 12;
    static final int UPPER = 16;
    static final int COUNT = 28;
  }

  /** Offsets of kiwami_wide4_node. */
  static final class Wide4Node {
    static final int STRUCT_BYTES = 128;
    static final int LOWER_X = 0;
    static final int LOWER_Y = 16;
    static final int LOWER_Z = 32;
    static final int UPPER_X = 48;
    static final int UPPER_Y = 64;
    static final int UPPER_Z = 80;
    static final int CHILD = 96;
    static final int COUNT = 112;
  }

  /** Offsets of kiwami_wide8_node. */
  static final class Wide8Node {
    static final int STRUCT_BYTES = 256;
    static final int LOWER_X = 0;
    static final int LOWER_Y = 32;
    static final int LOWER_Z = 64;
    static final int UPPER_X = 96;
    static final int UPPER_Y = 128;
    static final int UPPER_Z = 160;
    static final int CHILD = 192;
    static final int COUNT = 224;
  }

  /** Offsets of kiwami_compressed8_node. */
  static final class Compressed8Node {
    static final int STRUCT_BYTES = 80;
    static final int ORIGIN = 0;
    static final int EXPONENT = 12;
    static final int INNER_MASK = 15;
    static final int CHILD_BASE = 16;
    static final int PRIMITIVE_BASE = 20;
    static final int META = 24;
    static final int LOWER_X = 32;
    static final int LOWER_Y = 40;
    static final int LOWER_Z = 48;
    static final int UPPER_X = 56;
    static final int UPPER_Y = 64;
    static final int UPPER_Z = 72;
  }

  /** Offsets of kiwami_light. */
  static final class Light {
    static final int STRUCT_BYTES = 96;
    static final int TYPE = 0;
    static final int FLAGS = 4;
    static final int POINTS = 8;
    static final int DIRECTION = 56;
    static final int RADIUS = 68;
    static final int COS_INNER = 72;
    static final int COS_OUTER = 76;
    static final int POWER = 80;
    static final int USER_ID = 84;
    static final int LINK_MASK = 88;
  }

  /** Offsets of kiwami_light_mesh_desc. */
  static final class LightMeshDesc {
    static final int STRUCT_BYTES = 96;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int VERTICES = 8;
    static final int VERTEX_STRIDE = 16;
    static final int VERTEX_COUNT = 24;
    static final int INDICES = 32;
    static final int INDEX_STRIDE = 40;
    static final int TRIANGLE_COUNT = 48;
    static final int RADIANCES = 56;
    static final int RADIANCE_STRIDE = 64;
    static final int LINK_MASK = 72;
    static final int RADIANCE = 80;
    static final int USER_ID = 84;
    static final int USER_ID_STEP = 88;
    static final int RESERVED = 92;
  }

  /** Offsets of kiwami_light_instance_desc. */
  static final class LightInstanceDesc {
    static final int STRUCT_BYTES = 72;
    static final int STRUCT_SIZE = 0;
    static final int POWER_SCALE = 4;
    static final int TREE = 8;
    static final int LOCAL_TO_WORLD = 16;
    static final int LINK_MASK = 64;
  }

  /** Offsets of kiwami_light_tree_desc. */
  static final class LightTreeDesc {
    static final int STRUCT_BYTES = 24;
    static final int STRUCT_SIZE = 0;
    static final int WIDTH = 4;
    static final int BUILDER = 8;
    static final int DISTANT_PROBABILITY = 12;
    static final int FLAGS = 16;
    static final int RESERVED = 20;
  }

  /** Offsets of kiwami_light_tree_info. */
  static final class LightTreeInfo {
    static final int STRUCT_BYTES = 64;
    static final int STRUCT_SIZE = 0;
    static final int WIDTH = 4;
    static final int LIGHT_COUNT = 8;
    static final int INSTANCE_COUNT = 12;
    static final int DISTANT_COUNT = 16;
    static final int NODE_COUNT = 20;
    static final int DEPTH = 24;
    static final int RESERVED = 28;
    static final int BYTES = 32;
    static final int POWER = 40;
    static final int COST = 48;
    static final int BUILD_SECONDS = 56;
  }

  /** Offsets of kiwami_light_receiver. */
  static final class LightReceiver {
    static final int STRUCT_BYTES = 56;
    static final int POSITION = 0;
    static final int NORMAL = 12;
    static final int SEGMENT = 24;
    static final int FLAGS = 36;
    static final int LINK_MASK = 40;
    static final int RANDOM = 48;
  }

  /** Offsets of kiwami_light_choice. */
  static final class LightChoice {
    static final int STRUCT_BYTES = 24;
    static final int LIGHT_ID = 0;
    static final int INSTANCE_ID = 4;
    static final int USER_ID = 8;
    static final int PROBABILITY = 12;
    static final int RANDOM = 16;
  }

  /** Offsets of kiwami_light_name. */
  static final class LightName {
    static final int STRUCT_BYTES = 8;
    static final int LIGHT_ID = 0;
    static final int INSTANCE_ID = 4;
  }

  /** Offsets of kiwami_light_lobe. */
  static final class LightLobe {
    static final int STRUCT_BYTES = 16;
    static final int AXIS = 0;
    static final int ROUGHNESS = 12;
  }

  /** Offsets of kiwami_light_pixel. */
  static final class LightPixel {
    static final int STRUCT_BYTES = 12;
    static final int X = 0;
    static final int Y = 4;
    static final int SAMPLE = 8;
  }

  /** Offsets of kiwami_light_query. */
  static final class LightQuery {
    static final int STRUCT_BYTES = 72;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int METHOD = 8;
    static final int MAX_CHOICES = 12;
    static final int THRESHOLD = 16;
    static final int LOBE = 20;
    static final int ORDER = 24;
    static final int REACH = 28;
    static final int LOBES = 32;
    static final int LOBE_STRIDE = 40;
    static final int SEQUENCE = 48;
    static final int SEQUENCE_SEED = 52;
    static final int PIXELS = 56;
    static final int PIXEL_STRIDE = 64;
  }

  /** Offsets of kiwami_save_desc. */
  static final class SaveDesc {
    static final int STRUCT_BYTES = 48;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int PATH = 8;
    static final int WRITE = 16;
    static final int WRITE_USER = 24;
    static final int DATA = 32;
    static final int CAPACITY = 40;
  }

  /** Offsets of kiwami_load_desc. */
  static final class LoadDesc {
    static final int STRUCT_BYTES = 56;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int PATH = 8;
    static final int READ = 16;
    static final int READ_USER = 24;
    static final int DATA = 32;
    static final int SIZE = 40;
    static final int BVH_WIDTH = 48;
    static final int RESERVED = 52;
  }

  /** Offsets of kiwami_file_info. */
  static final class FileInfo {
    static final int STRUCT_BYTES = 56;
    static final int STRUCT_SIZE = 0;
    static final int KIND = 4;
    static final int FIT = 8;
    static final int FORMAT_VERSION = 12;
    static final int LIBRARY_VERSION = 16;
    static final int BVH_WIDTH = 20;
    static final int SECTION_COUNT = 24;
    static final int RESERVED = 28;
    static final int FILE_BYTES = 32;
    static final int TRIANGLE_COUNT = 40;
    static final int NODE_COUNT = 48;
  }

  /** Offsets of kiwami_moving_mesh_desc. */
  static final class MovingMeshDesc {
    static final int STRUCT_BYTES = 96;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int VERTICES = 8;
    static final int VERTEX_OFFSET = 16;
    static final int VERTEX_STRIDE = 24;
    static final int VERTEX_COUNT = 32;
    static final int STEP_STRIDE = 40;
    static final int INDICES = 48;
    static final int INDEX_OFFSET = 56;
    static final int INDEX_STRIDE = 64;
    static final int TRIANGLE_COUNT = 72;
    static final int STEP_COUNT = 80;
    static final int TIME_BEGIN = 84;
    static final int TIME_END = 88;
    static final int MASK = 92;
  }

  /** Offsets of kiwami_quaternion_transform. */
  static final class QuaternionTransform {
    static final int STRUCT_BYTES = 64;
    static final int SCALE_X = 0;
    static final int SCALE_Y = 4;
    static final int SCALE_Z = 8;
    static final int SKEW_XY = 12;
    static final int SKEW_XZ = 16;
    static final int SKEW_YZ = 20;
    static final int SHIFT_X = 24;
    static final int SHIFT_Y = 28;
    static final int SHIFT_Z = 32;
    static final int QUATERNION_R = 36;
    static final int QUATERNION_I = 40;
    static final int QUATERNION_J = 44;
    static final int QUATERNION_K = 48;
    static final int TRANSLATION_X = 52;
    static final int TRANSLATION_Y = 56;
    static final int TRANSLATION_Z = 60;
  }

  /** Offsets of kiwami_moving_instances_desc. */
  static final class MovingInstancesDesc {
    static final int STRUCT_BYTES = 112;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int SCENES = 8;
    static final int SCENE_COUNT = 16;
    static final int SCENE_INDICES = 24;
    static final int SCENE_INDEX_STRIDE = 32;
    static final int TRANSFORMS = 40;
    static final int TRANSFORM_STRIDE = 48;
    static final int STEP_STRIDE = 56;
    static final int COUNT = 64;
    static final int MASKS = 72;
    static final int MASK_STRIDE = 80;
    static final int FORMAT = 88;
    static final int STEP_COUNT = 92;
    static final int TIME_BEGIN = 96;
    static final int TIME_END = 100;
    static final int MASK = 104;
    static final int RESERVED = 108;
  }

  /** Offsets of kiwami_opacity_desc. */
  static final class OpacityDesc {
    static final int STRUCT_BYTES = 56;
    static final int STRUCT_SIZE = 0;
    static final int FORMAT = 4;
    static final int LEVEL = 8;
    static final int RESERVED = 12;
    static final int MAPS = 16;
    static final int MAP_STRIDE = 24;
    static final int MAP_COUNT = 32;
    static final int INDICES = 40;
    static final int INDEX_STRIDE = 48;
  }

  /** Offsets of kiwami_spheres_desc. */
  static final class SpheresDesc {
    static final int STRUCT_BYTES = 48;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int POINTS = 8;
    static final int POINT_OFFSET = 16;
    static final int POINT_STRIDE = 24;
    static final int SPHERE_COUNT = 32;
    static final int MASK = 40;
    static final int RESERVED = 44;
  }

  /** Offsets of kiwami_discs_desc. */
  static final class DiscsDesc {
    static final int STRUCT_BYTES = 72;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int POINTS = 8;
    static final int POINT_OFFSET = 16;
    static final int POINT_STRIDE = 24;
    static final int NORMALS = 32;
    static final int NORMAL_OFFSET = 40;
    static final int NORMAL_STRIDE = 48;
    static final int DISC_COUNT = 56;
    static final int MASK = 64;
    static final int RESERVED = 68;
  }

  /** Offsets of kiwami_curves_desc. */
  static final class CurvesDesc {
    static final int STRUCT_BYTES = 80;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int POINTS = 8;
    static final int POINT_OFFSET = 16;
    static final int POINT_STRIDE = 24;
    static final int POINT_COUNT = 32;
    static final int INDICES = 40;
    static final int INDEX_OFFSET = 48;
    static final int INDEX_STRIDE = 56;
    static final int SEGMENT_COUNT = 64;
    static final int MASK = 72;
    static final int RESERVED = 76;
  }

  /** Offsets of kiwami_interpolation. */
  static final class Interpolation {
    static final int STRUCT_BYTES = 184;
    static final int STRUCT_SIZE = 0;
    static final int CHANNELS = 4;
    static final int ATTRIBUTES = 8;
    static final int ATTRIBUTE_OFFSET = 16;
    static final int ATTRIBUTE_STRIDE = 24;
    static final int ATTRIBUTE_COUNT = 32;
    static final int INDICES = 40;
    static final int INDEX_OFFSET = 48;
    static final int INDEX_STRIDE = 56;
    static final int PRIMITIVE_ID = 64;
    static final int U = 80;
    static final int V = 96;
    static final int GEOMETRY_ID = 112;
    static final int GEOMETRY = 128;
    static final int RESERVED = 132;
    static final int VALUES = 136;
    static final int VALUE_STRIDE = 144;
    static final int DERIVATIVES_U = 152;
    static final int DERIVATIVE_U_STRIDE = 160;
    static final int DERIVATIVES_V = 168;
    static final int DERIVATIVE_V_STRIDE = 176;
  }

  /** Offsets of kiwami_tetrahedra_desc. */
  static final class TetrahedraDesc {
    static final int STRUCT_BYTES = 56;
    static final int STRUCT_SIZE = 0;
    static final int METHOD = 4;
    static final int VERTICES = 8;
    static final int VERTEX_STRIDE = 16;
    static final int VERTEX_COUNT = 24;
    static final int INDICES = 32;
    static final int INDEX_STRIDE = 40;
    static final int TETRAHEDRON_COUNT = 48;
  }

  /** Offsets of kiwami_tetrahedra_info. */
  static final class TetrahedraInfo {
    static final int STRUCT_BYTES = 72;
    static final int STRUCT_SIZE = 0;
    static final int METHOD = 4;
    static final int TETRAHEDRON_COUNT = 8;
    static final int SKIPPED_COUNT = 16;
    static final int INVERTED_COUNT = 24;
    static final int FACE_COUNT = 32;
    static final int BOUNDARY_FACE_COUNT = 40;
    static final int CROWDED_FACE_COUNT = 48;
    static final int BYTES = 56;
    static final int BUILD_SECONDS = 64;
  }

  /** Offsets of kiwami_tetrahedron_location. */
  static final class TetrahedronLocation {
    static final int STRUCT_BYTES = 20;
    static final int TETRAHEDRON_ID = 0;
    static final int WEIGHTS = 4;
  }

  /** Offsets of kiwami_user_hit. */
  static final class UserHit {
    static final int STRUCT_BYTES = 32;
    static final int T = 0;
    static final int U = 4;
    static final int V = 8;
    static final int NORMAL_X = 12;
    static final int NORMAL_Y = 16;
    static final int NORMAL_Z = 20;
    static final int PRIMITIVE_ID = 24;
    static final int RESERVED = 28;
  }

  /** Offsets of kiwami_user_intersection. */
  static final class UserIntersection {
    static final int STRUCT_BYTES = 48;
    static final int STRUCT_SIZE = 0;
    static final int PRIMITIVE_COUNT = 4;
    static final int PRIMITIVE_IDS = 8;
    static final int RAY = 16;
    static final int GEOMETRY_ID = 24;
    static final int HIT_CAPACITY = 28;
    static final int HITS = 32;
    static final int HIT_COUNT = 40;
    static final int RESERVED = 44;
  }

  /** Offsets of kiwami_user_geometry_desc. */
  static final class UserGeometryDesc {
    static final int STRUCT_BYTES = 56;
    static final int STRUCT_SIZE = 0;
    static final int FLAGS = 4;
    static final int COUNT = 8;
    static final int BOUNDS = 16;
    static final int INTERSECT = 24;
    static final int DESTROY = 32;
    static final int USER = 40;
    static final int MASK = 48;
    static final int RESERVED = 52;
  }

  static {
    com.sun.jna.Native.register(LibraryFile.path());
  }

  static native int kiwami_version();

  static native int kiwami_abi_version();

  static native Pointer kiwami_result_name(int result);

  static native long kiwami_last_error(Pointer device, Pointer text, long capacity);

  static native int kiwami_device_desc_init(Pointer desc, long size);

  static native int kiwami_device_create(Pointer desc, Pointer device);

  static native void kiwami_device_retain(Pointer device);

  static native void kiwami_device_release(Pointer device);

  static native int kiwami_device_get_info(Pointer device, Pointer info);

  static native Pointer kiwami_isa_name(int isa);

  static native int kiwami_triangle_mesh_desc_init(Pointer desc, long size);

  static native int kiwami_triangle_mesh_create(Pointer device, Pointer desc, Pointer geometry);

  static native int kiwami_triangle_mesh_update_vertices(Pointer geometry, Pointer vertices, long vertexOffset, long vertexStride);

  static native int kiwami_geometry_set_mask(Pointer geometry, int mask);

  static native void kiwami_geometry_retain(Pointer geometry);

  static native void kiwami_geometry_release(Pointer geometry);

  static native int kiwami_scene_create(Pointer device, Pointer scene);

  static native void kiwami_scene_retain(Pointer scene);

  static native void kiwami_scene_release(Pointer scene);

  static native int kiwami_scene_attach(Pointer scene, Pointer geometry, Pointer geometryId);

  static native int kiwami_scene_detach(Pointer scene, int geometryId);

  static native int kiwami_scene_replace(Pointer scene, int geometryId, Pointer geometry);

  static native int kiwami_scene_enable(Pointer scene, int geometryId, int isEnabled);

  static native int kiwami_scene_set_parameter(Pointer scene, int parameter, double value);

  static native int kiwami_parameter_bounds(int parameter, Pointer lowest, Pointer highest, Pointer preset);

  static native int kiwami_scene_set_representative_rays(Pointer scene, Pointer rays, long stride, long count);

  static native int kiwami_scene_set_optimizers(Pointer scene, Pointer methods, long count);

  static native int kiwami_quality_methods(int quality, Pointer builder, Pointer optimizers, Pointer optimizerCount, Pointer contraction);

  static native Pointer kiwami_method_name(int stage, int method);

  static native int kiwami_scene_set_progress(Pointer scene, Callback function, Pointer user);

  static native int kiwami_scene_commit(Pointer scene);

  static native int kiwami_scene_refit(Pointer scene);

  static native int kiwami_scene_get_info(Pointer scene, Pointer info);

  static native int kiwami_scene_validate(Pointer scene);

  static native int kiwami_instances_desc_init(Pointer desc, long size);

  static native int kiwami_instances_create(Pointer device, Pointer desc, Pointer geometry);

  static native int kiwami_ray_fields_init(Pointer rays, long size);

  static native int kiwami_hit_fields_init(Pointer hits, long size);

  static native int kiwami_query_init(Pointer query, long size);

  static native int kiwami_closest_hit(Pointer scene, Pointer rays, long rayStride, Pointer hits, long hitStride, long count, Pointer query);

  static native int kiwami_any_hit(Pointer scene, Pointer rays, long rayStride, Pointer occluded, long stride, long count, Pointer query);

  static native int kiwami_closest_hit_fields(Pointer scene, Pointer rays, Pointer hits, long count, Pointer query);

  static native int kiwami_any_hit_fields(Pointer scene, Pointer rays, Pointer occluded, long count, Pointer query);

  static native int kiwami_multi_hit(Pointer scene, Pointer rays, long rayStride, long count, int maxHits, Pointer hits, long hitCapacity, Pointer offsets, Pointer query);

  static native int kiwami_count_hits(Pointer scene, Pointer rays, long rayStride, Pointer counts, long stride, long count, Pointer query);

  static native int kiwami_multi_hit_fields(Pointer scene, Pointer rays, long count, int maxHits, Pointer hits, long hitCapacity, Pointer offsets, Pointer query);

  static native int kiwami_count_hits_fields(Pointer scene, Pointer rays, Pointer counts, long count, Pointer query);

  static native int kiwami_scene_get_bvh(Pointer scene, Pointer bvh);

  static native int kiwami_bvh_desc_init(Pointer desc, long size);

  static native int kiwami_bvh_build(Pointer device, Pointer desc, Pointer bvh);

  static native int kiwami_bvh_refit(Pointer bvh, Pointer boxes, long stride, long count);

  static native int kiwami_bvh_validate(Pointer bvh);

  static native void kiwami_bvh_retain(Pointer bvh);

  static native void kiwami_bvh_release(Pointer bvh);

  static native int kiwami_bvh_get_info(Pointer bvh, Pointer info);

  static native int kiwami_bvh_get_nodes(Pointer bvh, long first, long count, Pointer nodes, long stride);

  static native int kiwami_bvh_get_primitives(Pointer bvh, long first, long count, Pointer primitives, long stride);

  static native int kiwami_bvh_measure_desc_init(Pointer desc, long size);

  static native int kiwami_bvh_measure(Pointer bvh, Pointer desc, Pointer measures, Pointer nodes, long stride);

  static native int kiwami_scene_count_visits(Pointer scene, Pointer rays, long rayStride, long count, int query, Pointer visits, Pointer each, long eachStride);

  static native int kiwami_binary_tree_create(Pointer bvh, int layout, Pointer tree);

  static native void kiwami_binary_tree_retain(Pointer tree);

  static native void kiwami_binary_tree_release(Pointer tree);

  static native int kiwami_binary_tree_get_info(Pointer tree, Pointer info);

  static native int kiwami_binary_tree_validate(Pointer tree);

  static native int kiwami_binary_tree_closest_hit(Pointer tree, Pointer rays, long rayStride, Pointer hits, long hitStride, long count, Pointer visits);

  static native int kiwami_distribution_desc_init(Pointer desc, long size);

  static native int kiwami_distribution_create(Pointer device, Pointer desc, Pointer distribution);

  static native void kiwami_distribution_retain(Pointer distribution);

  static native void kiwami_distribution_release(Pointer distribution);

  static native int kiwami_distribution_get_info(Pointer distribution, Pointer info);

  static native int kiwami_distribution_sample(Pointer distribution, Pointer randoms, long randomStride, Pointer draws, long drawStride, long count);

  static native int kiwami_distribution_pdf(Pointer distribution, Pointer indices, long indexStride, Pointer probabilities, long probabilityStride, long count);

  static native int kiwami_bvh_export_counts(Pointer bvh, int format, Pointer nodeCount, Pointer primitiveCount);

  static native int kiwami_bvh_export(Pointer bvh, int format, Pointer nodes, long nodeBytes, Pointer primitives, long primitiveCount);

  static native int kiwami_light_tree_desc_init(Pointer desc, long size);

  static native int kiwami_light_mesh_desc_init(Pointer desc, long size);

  static native int kiwami_light_instance_desc_init(Pointer desc, long size);

  static native int kiwami_light_query_init(Pointer query, long size);

  static native int kiwami_light_tree_create(Pointer device, Pointer desc, Pointer tree);

  static native void kiwami_light_tree_retain(Pointer tree);

  static native void kiwami_light_tree_release(Pointer tree);

  static native int kiwami_light_tree_add_lights(Pointer tree, Pointer lights, long stride, long count, Pointer firstId);

  static native int kiwami_light_tree_add_mesh(Pointer tree, Pointer desc, Pointer firstId);

  static native int kiwami_light_tree_add_instance(Pointer tree, Pointer desc, Pointer instanceId);

  static native int kiwami_light_tree_set_lights(Pointer tree, int first, Pointer lights, long stride, long count);

  static native int kiwami_light_tree_set_powers(Pointer tree, int first, Pointer powers, long stride, long count);

  static native int kiwami_light_tree_set_instance(Pointer tree, int instanceId, Pointer desc);

  static native int kiwami_light_tree_commit(Pointer tree);

  static native int kiwami_light_tree_refit(Pointer tree);

  static native int kiwami_light_tree_get_info(Pointer tree, Pointer info);

  static native int kiwami_light_sample(Pointer tree, Pointer receivers, long receiverStride, Pointer choices, long choiceStride, long count, Pointer query);

  static native int kiwami_light_pdf(Pointer tree, Pointer receivers, long receiverStride, Pointer lights, long lightStride, Pointer probabilities, long probabilityStride, long count, Pointer query);

  static native int kiwami_save_desc_init(Pointer desc, long size);

  static native int kiwami_load_desc_init(Pointer desc, long size);

  static native int kiwami_scene_save(Pointer scene, Pointer desc, Pointer bytes);

  static native int kiwami_scene_load(Pointer device, Pointer desc, Pointer scene);

  static native int kiwami_bvh_save(Pointer bvh, Pointer desc, Pointer bytes);

  static native int kiwami_bvh_load(Pointer device, Pointer desc, Pointer bvh);

  static native int kiwami_light_tree_save(Pointer tree, Pointer desc, Pointer bytes);

  static native int kiwami_light_tree_load(Pointer device, Pointer desc, Pointer tree);

  static native int kiwami_file_get_info(Pointer device, Pointer desc, Pointer info);

  static native int kiwami_moving_mesh_desc_init(Pointer desc, long size);

  static native int kiwami_moving_mesh_create(Pointer device, Pointer desc, Pointer geometry);

  static native int kiwami_moving_instances_desc_init(Pointer desc, long size);

  static native int kiwami_moving_instances_create(Pointer device, Pointer desc, Pointer geometry);

  static native int kiwami_instances_transform(Pointer instances, long instance, float time, Pointer transform);

  static native int kiwami_opacity_desc_init(Pointer desc, long size);

  static native int kiwami_triangle_mesh_set_opacity(Pointer mesh, Pointer desc);

  static native int kiwami_opacity_micro_triangle(float u, float v, int level);

  static native int kiwami_spheres_desc_init(Pointer desc, long size);

  static native int kiwami_discs_desc_init(Pointer desc, long size);

  static native int kiwami_curves_desc_init(Pointer desc, long size);

  static native int kiwami_spheres_create(Pointer device, Pointer desc, Pointer geometry);

  static native int kiwami_discs_create(Pointer device, Pointer desc, Pointer geometry);

  static native int kiwami_curves_create(Pointer device, Pointer desc, Pointer geometry);

  static native int kiwami_interpolation_init(Pointer interpolation, long size);

  static native int kiwami_interpolate(Pointer mesh, Pointer interpolation, long count);

  static native int kiwami_hit_points(Pointer scene, Pointer hits, long hitStride, long count, Pointer points, long pointStride, Pointer errors, long errorStride);

  static native int kiwami_offset_origins(Pointer scene, Pointer hits, long hitStride, Pointer directions, long directionStride, long count, Pointer origins, long originStride);

  static native int kiwami_tetrahedra_desc_init(Pointer desc, long size);

  static native int kiwami_tetrahedra_create(Pointer device, Pointer desc, Pointer tetrahedra);

  static native void kiwami_tetrahedra_retain(Pointer tetrahedra);

  static native void kiwami_tetrahedra_release(Pointer tetrahedra);

  static native int kiwami_tetrahedra_get_info(Pointer tetrahedra, Pointer info);

  static native int kiwami_tetrahedra_locate(Pointer tetrahedra, Pointer points, long pointStride, Pointer locations, long locationStride, long count);

  static native int kiwami_user_geometry_desc_init(Pointer desc, long size);

  static native int kiwami_user_geometry_create(Pointer device, Pointer desc, Pointer geometry);
}
