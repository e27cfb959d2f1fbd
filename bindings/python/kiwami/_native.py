# SPDX-License-Identifier: Apache-2.0
"""The C interface for ctypes. Generated from the headers by bindings/schema/generate.py;
do not edit."""

import ctypes

KIWAMI_ABI_VERSION = 0
KIWAMI_FILE_FORMAT_VERSION = 2
KIWAMI_INVALID_ID = 4294967295
KIWAMI_LIGHT_MAX_CHOICES = 64
KIWAMI_MAX_COORDINATE = 1.152921504606847e+18
KIWAMI_MAX_INSTANCE_DEPTH = 8
KIWAMI_OPACITY_ALL_OPAQUE = 4294967293
KIWAMI_OPACITY_ALL_TRANSPARENT = 4294967292
KIWAMI_OPACITY_ALL_UNKNOWN_OPAQUE = 4294967295
KIWAMI_OPACITY_ALL_UNKNOWN_TRANSPARENT = 4294967294
KIWAMI_VERSION_MAJOR = 0
KIWAMI_VERSION_MINOR = 1
KIWAMI_VERSION_PATCH = 0
KIWAMI_OK = 0
KIWAMI_ERROR_INVALID_ARGUMENT = -1
KIWAMI_ERROR_INVALID_STATE = -2
KIWAMI_ERROR_OUT_OF_MEMORY = -3
KIWAMI_ERROR_UNSUPPORTED_ISA = -4
KIWAMI_ERROR_TOO_LARGE = -5
KIWAMI_ERROR_CALLBACK = -6
KIWAMI_ERROR_VALIDATION = -7
KIWAMI_ERROR_INTERNAL = -8
KIWAMI_ERROR_CAPACITY = -9
KIWAMI_ERROR_INVALID_FILE = -10
KIWAMI_ERROR_IO = -11
KIWAMI_ERROR_CANCELLED = -12
KIWAMI_ISA_AUTO = 0
KIWAMI_ISA_SCALAR = 1
KIWAMI_ISA_SSE = 2
KIWAMI_ISA_AVX2 = 3
KIWAMI_ISA_AVX512 = 4
KIWAMI_DEVICE_VALIDATE = 1
KIWAMI_MESH_SHARE_BUFFERS = 1
KIWAMI_PARAMETER_BVH_WIDTH = 1
KIWAMI_PARAMETER_MERGE_LEAVES = 2
KIWAMI_PARAMETER_MERGE_RING = 3
KIWAMI_PARAMETER_BIN_COUNT = 4
KIWAMI_PARAMETER_MAX_LEAF_SIZE = 5
KIWAMI_PARAMETER_NODE_COST = 6
KIWAMI_PARAMETER_LEAF_COST = 7
KIWAMI_PARAMETER_VALIDATE_BUILD = 8
KIWAMI_PARAMETER_CONTRACTION = 9
KIWAMI_PARAMETER_BUILDER = 10
KIWAMI_PARAMETER_SPLIT_BUDGET = 11
KIWAMI_PARAMETER_SPLIT_ALPHA = 12
KIWAMI_PARAMETER_BIN_HALVING = 13
KIWAMI_PARAMETER_REASSIGN = 14
KIWAMI_PARAMETER_AAC_QUALITY = 17
KIWAMI_PARAMETER_CURVE_CODE = 18
KIWAMI_PARAMETER_LBVH_DELTA = 19
KIWAMI_PARAMETER_LBVH_CHUNK_SIZE = 20
KIWAMI_PARAMETER_LAYOUT = 21
KIWAMI_PARAMETER_QUALITY = 30
KIWAMI_PARAMETER_REBRAID = 40
KIWAMI_PARAMETER_REBRAID_BUDGET = 41
KIWAMI_PARAMETER_TWO_LEVEL = 42
KIWAMI_PARAMETER_DIVIDE_TIME = 43
KIWAMI_REBRAID_OFF = 0
KIWAMI_REBRAID_FULL = 1
KIWAMI_REBRAID_ROOTS = 2
KIWAMI_LAYOUT_FAST = 0
KIWAMI_LAYOUT_COMPACT = 1
KIWAMI_STAGE_BUILDER = 1
KIWAMI_STAGE_OPTIMIZER = 2
KIWAMI_STAGE_CONTRACTION = 3
KIWAMI_QUALITY_BALANCED = 0
KIWAMI_QUALITY_FAST = 1
KIWAMI_QUALITY_BEST = 2
KIWAMI_BUILDER_BINNED_SAH = 0
KIWAMI_BUILDER_LBVH = 1
KIWAMI_BUILDER_PLOC = 2
KIWAMI_BUILDER_SWEEP_SAH = 3
KIWAMI_BUILDER_SPATIAL_SPLIT = 4
KIWAMI_BUILDER_AGGLOMERATIVE = 5
KIWAMI_BUILDER_AAC = 6
KIWAMI_BUILDER_MINI_TREE = 7
KIWAMI_BUILDER_OIBVH = 8
KIWAMI_BUILDER_WIDE_BOTTOM_UP = 9
KIWAMI_BUILDER_STR = 10
KIWAMI_BUILDER_TRBVH = 11
KIWAMI_BUILDER_WIDE_TOP_DOWN = 12
KIWAMI_BUILDER_WIDE_LINEAR = 13
KIWAMI_BUILDER_TRIAL = 14
KIWAMI_OPTIMIZER_PARALLEL_REINSERTION = 1
KIWAMI_OPTIMIZER_ROTATION = 2
KIWAMI_OPTIMIZER_TREELET = 3
KIWAMI_OPTIMIZER_AGGLOMERATIVE_TREELET = 4
KIWAMI_OPTIMIZER_REINSERTION = 5
KIWAMI_OPTIMIZER_REORDER_SATO = 6
KIWAMI_OPTIMIZER_REORDER_NARY = 7
KIWAMI_CONTRACTION_SURFACE_AREA = 0
KIWAMI_CONTRACTION_OPTIMAL = 1
KIWAMI_CONTRACTION_RAY_DISTRIBUTION = 2
KIWAMI_MAX_OPTIMIZERS = 8
KIWAMI_INSTANCES_SHARE_BUFFERS = 1
KIWAMI_RAY_CULL_BACK_FACES = 1
KIWAMI_RAY_CULL_FRONT_FACES = 2
KIWAMI_FILTER_REJECT = 0
KIWAMI_FILTER_ACCEPT = 1
KIWAMI_FILTER_ACCEPT_AND_STOP = 2
KIWAMI_QUERY_CALLING_THREAD = 1
KIWAMI_MEASURE_WITHOUT_EPO = 1
KIWAMI_COUNT_CLOSEST_HIT = 0
KIWAMI_COUNT_ANY_HIT = 1
KIWAMI_BINARY_LAYOUT_BOXES = 0
KIWAMI_BINARY_LAYOUT_DUAL_SPLIT = 1
KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST = 0
KIWAMI_DISTRIBUTION_ALIAS_TABLE = 1
KIWAMI_EXPORT_BINARY = 1
KIWAMI_EXPORT_WIDE4 = 2
KIWAMI_EXPORT_WIDE8 = 3
KIWAMI_EXPORT_COMPRESSED8 = 4
KIWAMI_LIGHT_POINT = 0
KIWAMI_LIGHT_SPOT = 1
KIWAMI_LIGHT_TRIANGLE = 2
KIWAMI_LIGHT_QUAD = 3
KIWAMI_LIGHT_SPHERE = 4
KIWAMI_LIGHT_DISC = 5
KIWAMI_LIGHT_DISTANT = 6
KIWAMI_LIGHT_ENVIRONMENT = 7
KIWAMI_LIGHT_TWO_SIDED = 1
KIWAMI_LIGHT_BUILDER_SAOH = 0
KIWAMI_LIGHT_BUILDER_OCTANTS = 1
KIWAMI_LIGHT_TREE_WITH_ROULETTE = 1
KIWAMI_RECEIVER_BOTH_SIDES = 1
KIWAMI_LIGHT_METHOD_TREE = 0
KIWAMI_LIGHT_METHOD_POWER = 1
KIWAMI_LIGHT_METHOD_TREE_SPLITTING = 2
KIWAMI_LIGHT_METHOD_LIGHTCUTS = 3
KIWAMI_LIGHT_METHOD_LAZY_ROULETTE = 4
KIWAMI_LIGHT_METHOD_CULLING = 5
KIWAMI_LIGHT_METHOD_ROULETTE = 6
KIWAMI_LIGHT_LOBE_COSINE = 0
KIWAMI_LIGHT_LOBE_TANGENT_SPHERE = 1
KIWAMI_LIGHT_LOBE_GLOSSY = 2
KIWAMI_LIGHT_ORDER_XOR = 0
KIWAMI_LIGHT_ORDER_SCRAMBLED = 1
KIWAMI_LIGHT_SEQUENCE_RANDOM = 0
KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE = 1
KIWAMI_LIGHT_QUERY_CALLING_THREAD = 1
KIWAMI_LOAD_MAP = 1
KIWAMI_LOAD_TRUSTED = 2
KIWAMI_FILE_SCENE = 1
KIWAMI_FILE_BVH = 2
KIWAMI_FILE_LIGHTS = 3
KIWAMI_FIT_NATIVE = 0
KIWAMI_FIT_SCALAR = 1
KIWAMI_FIT_NONE = 2
KIWAMI_MOVING_MESH_SHARE_BUFFERS = 1
KIWAMI_MAX_TIME_STEPS = 129
KIWAMI_TRANSFORM_MATRIX = 0
KIWAMI_TRANSFORM_QUATERNION = 1
KIWAMI_OPACITY_TRANSPARENT = 0
KIWAMI_OPACITY_OPAQUE = 1
KIWAMI_OPACITY_UNKNOWN_TRANSPARENT = 2
KIWAMI_OPACITY_UNKNOWN_OPAQUE = 3
KIWAMI_OPACITY_2_STATES = 1
KIWAMI_OPACITY_4_STATES = 2
KIWAMI_OPACITY_MAX_LEVEL = 6
KIWAMI_SHAPES_SHARE_BUFFERS = 1
KIWAMI_TETRAHEDRA_BOXES = 0
KIWAMI_TETRAHEDRA_FACES = 1
KIWAMI_USER_HITS_PER_PRIMITIVE = 4

kiwami_parallel_task = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_size_t)

kiwami_parallel_runner = ctypes.CFUNCTYPE(
    ctypes.c_int32,
    ctypes.c_void_p,
    ctypes.c_size_t,
    ctypes.c_void_p,
    ctypes.c_void_p,
)

kiwami_allocate = ctypes.CFUNCTYPE(
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_size_t,
    ctypes.c_size_t,
)

kiwami_deallocate = ctypes.CFUNCTYPE(
    None,
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_size_t,
    ctypes.c_size_t,
)

kiwami_log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int32, ctypes.c_void_p)

kiwami_progress = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_double)

kiwami_filter_function = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)

kiwami_write = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)

kiwami_read = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)

kiwami_user_bounds_function = ctypes.CFUNCTYPE(
    ctypes.c_int32,
    ctypes.c_void_p,
    ctypes.c_uint32,
    ctypes.c_uint32,
    ctypes.c_void_p,
)

kiwami_user_intersect_function = ctypes.CFUNCTYPE(
    ctypes.c_int32,
    ctypes.c_void_p,
    ctypes.c_void_p,
)

kiwami_user_destroy_function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)


class kiwami_device_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("isa", ctypes.c_uint32),
        ("thread_count", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("runner", ctypes.c_void_p),
        ("runner_user", ctypes.c_void_p),
        ("runner_width", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("allocate", ctypes.c_void_p),
        ("deallocate", ctypes.c_void_p),
        ("allocator_user", ctypes.c_void_p),
        ("log", ctypes.c_void_p),
        ("log_user", ctypes.c_void_p),
        ("memory_limit", ctypes.c_uint64),
    ]


class kiwami_device_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("isa", ctypes.c_uint32),
        ("isa_available", ctypes.c_uint32),
        ("isa_built", ctypes.c_uint32),
        ("native_widths", ctypes.c_uint32),
        ("default_bvh_width", ctypes.c_uint32),
        ("thread_count", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("memory_bytes", ctypes.c_uint64),
        ("memory_peak_bytes", ctypes.c_uint64),
        ("memory_limit", ctypes.c_uint64),
    ]


class kiwami_triangle_mesh_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("vertices", ctypes.c_void_p),
        ("vertex_offset", ctypes.c_uint64),
        ("vertex_stride", ctypes.c_uint64),
        ("vertex_count", ctypes.c_uint64),
        ("indices", ctypes.c_void_p),
        ("index_offset", ctypes.c_uint64),
        ("index_stride", ctypes.c_uint64),
        ("triangle_count", ctypes.c_uint64),
        ("mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_scene_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("bvh_width", ctypes.c_uint32),
        ("leaf_width", ctypes.c_uint32),
        ("bvh_depth", ctypes.c_uint32),
        ("triangle_count", ctypes.c_uint64),
        ("skipped_count", ctypes.c_uint64),
        ("node_count", ctypes.c_uint64),
        ("leaf_block_count", ctypes.c_uint64),
        ("node_bytes", ctypes.c_uint64),
        ("leaf_bytes", ctypes.c_uint64),
        ("total_bytes", ctypes.c_uint64),
        ("peak_build_bytes", ctypes.c_uint64),
        ("node_fill", ctypes.c_double),
        ("leaf_fill", ctypes.c_double),
        ("sah_cost", ctypes.c_double),
        ("build_seconds", ctypes.c_double),
        ("bounds_min", ctypes.c_float * 3),
        ("bounds_max", ctypes.c_float * 3),
        ("reference_count", ctypes.c_uint64),
        ("refit_count", ctypes.c_uint64),
        ("instance_count", ctypes.c_uint64),
        ("instance_tree_bytes", ctypes.c_uint64),
        ("instance_depth", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_instances_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("scenes", ctypes.c_void_p),
        ("scene_count", ctypes.c_uint64),
        ("scene_indices", ctypes.c_void_p),
        ("scene_index_stride", ctypes.c_uint64),
        ("transforms", ctypes.c_void_p),
        ("transform_stride", ctypes.c_uint64),
        ("count", ctypes.c_uint64),
        ("masks", ctypes.c_void_p),
        ("mask_stride", ctypes.c_uint64),
        ("mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_ray(ctypes.Structure):
    _fields_ = [
        ("origin_x", ctypes.c_float),
        ("origin_y", ctypes.c_float),
        ("origin_z", ctypes.c_float),
        ("tmin", ctypes.c_float),
        ("direction_x", ctypes.c_float),
        ("direction_y", ctypes.c_float),
        ("direction_z", ctypes.c_float),
        ("tmax", ctypes.c_float),
        ("time", ctypes.c_float),
        ("mask", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("id", ctypes.c_uint32),
    ]


class kiwami_hit(ctypes.Structure):
    _fields_ = [
        ("t", ctypes.c_float),
        ("u", ctypes.c_float),
        ("v", ctypes.c_float),
        ("normal_x", ctypes.c_float),
        ("normal_y", ctypes.c_float),
        ("normal_z", ctypes.c_float),
        ("primitive_id", ctypes.c_uint32),
        ("geometry_id", ctypes.c_uint32),
        ("instance_id", ctypes.c_uint32),
    ]


class kiwami_input_field(ctypes.Structure):
    _fields_ = [
        ("data", ctypes.c_void_p),
        ("stride", ctypes.c_uint64),
    ]


class kiwami_output_field(ctypes.Structure):
    _fields_ = [
        ("data", ctypes.c_void_p),
        ("stride", ctypes.c_uint64),
    ]


class kiwami_ray_fields(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("origin_x", kiwami_input_field),
        ("origin_y", kiwami_input_field),
        ("origin_z", kiwami_input_field),
        ("direction_x", kiwami_input_field),
        ("direction_y", kiwami_input_field),
        ("direction_z", kiwami_input_field),
        ("tmin", kiwami_input_field),
        ("tmax", kiwami_input_field),
        ("time", kiwami_input_field),
        ("mask", kiwami_input_field),
        ("flags", kiwami_input_field),
    ]


class kiwami_hit_fields(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("t", kiwami_output_field),
        ("u", kiwami_output_field),
        ("v", kiwami_output_field),
        ("normal_x", kiwami_output_field),
        ("normal_y", kiwami_output_field),
        ("normal_z", kiwami_output_field),
        ("primitive_id", kiwami_output_field),
        ("geometry_id", kiwami_output_field),
        ("instance_id", kiwami_output_field),
    ]


class kiwami_exclusion(ctypes.Structure):
    _fields_ = [
        ("primitive_id", ctypes.c_uint32),
        ("geometry_id", ctypes.c_uint32),
        ("instance_id", ctypes.c_uint32),
    ]


class kiwami_filter_candidate(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("depth", ctypes.c_uint32),
        ("ray", ctypes.c_uint64),
        ("hit", kiwami_hit),
        ("reserved", ctypes.c_uint32),
        ("instance_path", ctypes.c_uint32 * 8),
    ]


class kiwami_query(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("instance_paths", ctypes.c_void_p),
        ("instance_path_stride", ctypes.c_uint64),
        ("exclusions", ctypes.c_void_p),
        ("exclusion_stride", ctypes.c_uint64),
        ("exclusion_paths", ctypes.c_void_p),
        ("exclusion_path_stride", ctypes.c_uint64),
        ("filter", ctypes.c_void_p),
        ("filter_user", ctypes.c_void_p),
    ]


class kiwami_bvh_node(ctypes.Structure):
    _fields_ = [
        ("lower", ctypes.c_float * 3),
        ("upper", ctypes.c_float * 3),
        ("parent", ctypes.c_uint32),
        ("depth", ctypes.c_uint32),
        ("first_child", ctypes.c_uint32),
        ("child_count", ctypes.c_uint32),
        ("first_primitive", ctypes.c_uint32),
        ("primitive_count", ctypes.c_uint32),
        ("storage_index", ctypes.c_uint32),
        ("storage_mask", ctypes.c_uint32),
    ]


class kiwami_bvh_primitive(ctypes.Structure):
    _fields_ = [
        ("geometry_id", ctypes.c_uint32),
        ("primitive_id", ctypes.c_uint32),
    ]


class kiwami_bvh_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("width", ctypes.c_uint32),
        ("leaf_width", ctypes.c_uint32),
        ("depth", ctypes.c_uint32),
        ("node_count", ctypes.c_uint32),
        ("leaf_count", ctypes.c_uint32),
        ("primitive_count", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("bytes", ctypes.c_uint64),
        ("skipped_count", ctypes.c_uint64),
        ("build_seconds", ctypes.c_double),
    ]


class kiwami_parameter_value(ctypes.Structure):
    _fields_ = [
        ("parameter", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("value", ctypes.c_double),
    ]


class kiwami_bvh_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("width", ctypes.c_uint32),
        ("boxes", ctypes.c_void_p),
        ("box_stride", ctypes.c_uint64),
        ("box_count", ctypes.c_uint64),
        ("geometry", ctypes.c_void_p),
        ("parameters", ctypes.c_void_p),
        ("parameter_count", ctypes.c_uint64),
        ("optimizers", ctypes.c_void_p),
        ("optimizer_count", ctypes.c_uint64),
    ]


class kiwami_bvh_measure_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("node_cost", ctypes.c_double),
        ("leaf_cost", ctypes.c_double),
        ("block_size", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_bvh_measures(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("sah", ctypes.c_double),
        ("epo", ctypes.c_double),
        ("node_area", ctypes.c_double),
        ("leaf_area", ctypes.c_double),
        ("surface_area", ctypes.c_double),
    ]


class kiwami_bvh_node_measures(ctypes.Structure):
    _fields_ = [
        ("area", ctypes.c_double),
        ("sah", ctypes.c_double),
        ("epo", ctypes.c_double),
    ]


class kiwami_visits(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("ray_count", ctypes.c_uint64),
        ("hit_count", ctypes.c_uint64),
        ("node_visits", ctypes.c_uint64),
        ("leaf_visits", ctypes.c_uint64),
        ("leaf_count_variability", ctypes.c_double),
    ]


class kiwami_ray_visits(ctypes.Structure):
    _fields_ = [
        ("node_visits", ctypes.c_uint32),
        ("leaf_visits", ctypes.c_uint32),
    ]


class kiwami_binary_tree_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("layout", ctypes.c_uint32),
        ("node_count", ctypes.c_uint64),
        ("split_count", ctypes.c_uint64),
        ("carve_count", ctypes.c_uint64),
        ("leaf_count", ctypes.c_uint64),
        ("primitive_count", ctypes.c_uint64),
        ("node_bytes", ctypes.c_uint64),
        ("bytes", ctypes.c_uint64),
    ]


class kiwami_binary_visits(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("node_visits", ctypes.c_uint64),
        ("plane_tests", ctypes.c_uint64),
        ("leaf_visits", ctypes.c_uint64),
    ]


class kiwami_distribution_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("method", ctypes.c_uint32),
        ("weights", ctypes.c_void_p),
        ("weight_stride", ctypes.c_uint64),
        ("weight_count", ctypes.c_uint64),
    ]


class kiwami_distribution_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("method", ctypes.c_uint32),
        ("weight_count", ctypes.c_uint64),
        ("bytes", ctypes.c_uint64),
        ("total", ctypes.c_double),
        ("mean_steps", ctypes.c_double),
        ("most_steps", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_draw(ctypes.Structure):
    _fields_ = [
        ("index", ctypes.c_uint32),
        ("probability", ctypes.c_float),
        ("random", ctypes.c_double),
    ]


class kiwami_binary_node(ctypes.Structure):
    _fields_ = [
        ("lower", ctypes.c_float * 3),
        ("first", ctypes.c_uint32),
        ("upper", ctypes.c_float * 3),
        ("count", ctypes.c_uint32),
    ]


class kiwami_wide4_node(ctypes.Structure):
    _fields_ = [
        ("lower_x", ctypes.c_float * 4),
        ("lower_y", ctypes.c_float * 4),
        ("lower_z", ctypes.c_float * 4),
        ("upper_x", ctypes.c_float * 4),
        ("upper_y", ctypes.c_float * 4),
        ("upper_z", ctypes.c_float * 4),
        ("child", ctypes.c_uint32 * 4),
        ("count", ctypes.c_uint32 * 4),
    ]


class kiwami_wide8_node(ctypes.Structure):
    _fields_ = [
        ("lower_x", ctypes.c_float * 8),
        ("lower_y", ctypes.c_float * 8),
        ("lower_z", ctypes.c_float * 8),
        ("upper_x", ctypes.c_float * 8),
        ("upper_y", ctypes.c_float * 8),
        ("upper_z", ctypes.c_float * 8),
        ("child", ctypes.c_uint32 * 8),
        ("count", ctypes.c_uint32 * 8),
    ]


class kiwami_compressed8_node(ctypes.Structure):
    _fields_ = [
        ("origin", ctypes.c_float * 3),
        ("exponent", ctypes.c_uint8 * 3),
        ("inner_mask", ctypes.c_uint8),
        ("child_base", ctypes.c_uint32),
        ("primitive_base", ctypes.c_uint32),
        ("meta", ctypes.c_uint8 * 8),
        ("lower_x", ctypes.c_uint8 * 8),
        ("lower_y", ctypes.c_uint8 * 8),
        ("lower_z", ctypes.c_uint8 * 8),
        ("upper_x", ctypes.c_uint8 * 8),
        ("upper_y", ctypes.c_uint8 * 8),
        ("upper_z", ctypes.c_uint8 * 8),
    ]


class kiwami_light(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("points", ctypes.c_float * 12),
        ("direction", ctypes.c_float * 3),
        ("radius", ctypes.c_float),
        ("cos_inner", ctypes.c_float),
        ("cos_outer", ctypes.c_float),
        ("power", ctypes.c_float),
        ("user_id", ctypes.c_uint32),
        ("link_mask", ctypes.c_uint64),
    ]


class kiwami_light_mesh_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("vertices", ctypes.c_void_p),
        ("vertex_stride", ctypes.c_uint64),
        ("vertex_count", ctypes.c_uint64),
        ("indices", ctypes.c_void_p),
        ("index_stride", ctypes.c_uint64),
        ("triangle_count", ctypes.c_uint64),
        ("radiances", ctypes.c_void_p),
        ("radiance_stride", ctypes.c_uint64),
        ("link_mask", ctypes.c_uint64),
        ("radiance", ctypes.c_float),
        ("user_id", ctypes.c_uint32),
        ("user_id_step", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_light_instance_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("power_scale", ctypes.c_float),
        ("tree", ctypes.c_void_p),
        ("local_to_world", ctypes.c_float * 12),
        ("link_mask", ctypes.c_uint64),
    ]


class kiwami_light_tree_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("width", ctypes.c_uint32),
        ("builder", ctypes.c_uint32),
        ("distant_probability", ctypes.c_float),
        ("flags", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_light_tree_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("width", ctypes.c_uint32),
        ("light_count", ctypes.c_uint32),
        ("instance_count", ctypes.c_uint32),
        ("distant_count", ctypes.c_uint32),
        ("node_count", ctypes.c_uint32),
        ("depth", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("bytes", ctypes.c_uint64),
        ("power", ctypes.c_double),
        ("cost", ctypes.c_double),
        ("build_seconds", ctypes.c_double),
    ]


class kiwami_light_receiver(ctypes.Structure):
    _fields_ = [
        ("position", ctypes.c_float * 3),
        ("normal", ctypes.c_float * 3),
        ("segment", ctypes.c_float * 3),
        ("flags", ctypes.c_uint32),
        ("link_mask", ctypes.c_uint64),
        ("random", ctypes.c_double),
    ]


class kiwami_light_choice(ctypes.Structure):
    _fields_ = [
        ("light_id", ctypes.c_uint32),
        ("instance_id", ctypes.c_uint32),
        ("user_id", ctypes.c_uint32),
        ("probability", ctypes.c_float),
        ("random", ctypes.c_double),
    ]


class kiwami_light_name(ctypes.Structure):
    _fields_ = [
        ("light_id", ctypes.c_uint32),
        ("instance_id", ctypes.c_uint32),
    ]


class kiwami_light_lobe(ctypes.Structure):
    _fields_ = [
        ("axis", ctypes.c_float * 3),
        ("roughness", ctypes.c_float),
    ]


class kiwami_light_pixel(ctypes.Structure):
    _fields_ = [
        ("x", ctypes.c_uint32),
        ("y", ctypes.c_uint32),
        ("sample", ctypes.c_uint32),
    ]


class kiwami_light_query(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("method", ctypes.c_uint32),
        ("max_choices", ctypes.c_uint32),
        ("threshold", ctypes.c_float),
        ("lobe", ctypes.c_uint32),
        ("order", ctypes.c_uint32),
        ("reach", ctypes.c_float),
        ("lobes", ctypes.c_void_p),
        ("lobe_stride", ctypes.c_uint64),
        ("sequence", ctypes.c_uint32),
        ("sequence_seed", ctypes.c_uint32),
        ("pixels", ctypes.c_void_p),
        ("pixel_stride", ctypes.c_uint64),
    ]


class kiwami_save_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("path", ctypes.c_void_p),
        ("write", ctypes.c_void_p),
        ("write_user", ctypes.c_void_p),
        ("data", ctypes.c_void_p),
        ("capacity", ctypes.c_uint64),
    ]


class kiwami_load_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("path", ctypes.c_void_p),
        ("read", ctypes.c_void_p),
        ("read_user", ctypes.c_void_p),
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_uint64),
        ("bvh_width", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_file_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("kind", ctypes.c_uint32),
        ("fit", ctypes.c_uint32),
        ("format_version", ctypes.c_uint32),
        ("library_version", ctypes.c_uint32),
        ("bvh_width", ctypes.c_uint32),
        ("section_count", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("file_bytes", ctypes.c_uint64),
        ("triangle_count", ctypes.c_uint64),
        ("node_count", ctypes.c_uint64),
    ]


class kiwami_moving_mesh_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("vertices", ctypes.c_void_p),
        ("vertex_offset", ctypes.c_uint64),
        ("vertex_stride", ctypes.c_uint64),
        ("vertex_count", ctypes.c_uint64),
        ("step_stride", ctypes.c_uint64),
        ("indices", ctypes.c_void_p),
        ("index_offset", ctypes.c_uint64),
        ("index_stride", ctypes.c_uint64),
        ("triangle_count", ctypes.c_uint64),
        ("step_count", ctypes.c_uint32),
        ("time_begin", ctypes.c_float),
        ("time_end", ctypes.c_float),
        ("mask", ctypes.c_uint32),
    ]


class kiwami_quaternion_transform(ctypes.Structure):
    _fields_ = [
        ("scale_x", ctypes.c_float),
        ("scale_y", ctypes.c_float),
        ("scale_z", ctypes.c_float),
        ("skew_xy", ctypes.c_float),
        ("skew_xz", ctypes.c_float),
        ("skew_yz", ctypes.c_float),
        ("shift_x", ctypes.c_float),
        ("shift_y", ctypes.c_float),
        ("shift_z", ctypes.c_float),
        ("quaternion_r", ctypes.c_float),
        ("quaternion_i", ctypes.c_float),
        ("quaternion_j", ctypes.c_float),
        ("quaternion_k", ctypes.c_float),
        ("translation_x", ctypes.c_float),
        ("translation_y", ctypes.c_float),
        ("translation_z", ctypes.c_float),
    ]


class kiwami_moving_instances_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("scenes", ctypes.c_void_p),
        ("scene_count", ctypes.c_uint64),
        ("scene_indices", ctypes.c_void_p),
        ("scene_index_stride", ctypes.c_uint64),
        ("transforms", ctypes.c_void_p),
        ("transform_stride", ctypes.c_uint64),
        ("step_stride", ctypes.c_uint64),
        ("count", ctypes.c_uint64),
        ("masks", ctypes.c_void_p),
        ("mask_stride", ctypes.c_uint64),
        ("format", ctypes.c_uint32),
        ("step_count", ctypes.c_uint32),
        ("time_begin", ctypes.c_float),
        ("time_end", ctypes.c_float),
        ("mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_opacity_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("format", ctypes.c_uint32),
        ("level", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("maps", ctypes.c_void_p),
        ("map_stride", ctypes.c_uint64),
        ("map_count", ctypes.c_uint64),
        ("indices", ctypes.c_void_p),
        ("index_stride", ctypes.c_uint64),
    ]


class kiwami_spheres_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("points", ctypes.c_void_p),
        ("point_offset", ctypes.c_uint64),
        ("point_stride", ctypes.c_uint64),
        ("sphere_count", ctypes.c_uint64),
        ("mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_discs_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("points", ctypes.c_void_p),
        ("point_offset", ctypes.c_uint64),
        ("point_stride", ctypes.c_uint64),
        ("normals", ctypes.c_void_p),
        ("normal_offset", ctypes.c_uint64),
        ("normal_stride", ctypes.c_uint64),
        ("disc_count", ctypes.c_uint64),
        ("mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_curves_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("points", ctypes.c_void_p),
        ("point_offset", ctypes.c_uint64),
        ("point_stride", ctypes.c_uint64),
        ("point_count", ctypes.c_uint64),
        ("indices", ctypes.c_void_p),
        ("index_offset", ctypes.c_uint64),
        ("index_stride", ctypes.c_uint64),
        ("segment_count", ctypes.c_uint64),
        ("mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_interpolation(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("channels", ctypes.c_uint32),
        ("attributes", ctypes.c_void_p),
        ("attribute_offset", ctypes.c_uint64),
        ("attribute_stride", ctypes.c_uint64),
        ("attribute_count", ctypes.c_uint64),
        ("indices", ctypes.c_void_p),
        ("index_offset", ctypes.c_uint64),
        ("index_stride", ctypes.c_uint64),
        ("primitive_id", kiwami_input_field),
        ("u", kiwami_input_field),
        ("v", kiwami_input_field),
        ("geometry_id", kiwami_input_field),
        ("geometry", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("values", ctypes.c_void_p),
        ("value_stride", ctypes.c_uint64),
        ("derivatives_u", ctypes.c_void_p),
        ("derivative_u_stride", ctypes.c_uint64),
        ("derivatives_v", ctypes.c_void_p),
        ("derivative_v_stride", ctypes.c_uint64),
    ]


class kiwami_tetrahedra_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("method", ctypes.c_uint32),
        ("vertices", ctypes.c_void_p),
        ("vertex_stride", ctypes.c_uint64),
        ("vertex_count", ctypes.c_uint64),
        ("indices", ctypes.c_void_p),
        ("index_stride", ctypes.c_uint64),
        ("tetrahedron_count", ctypes.c_uint64),
    ]


class kiwami_tetrahedra_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("method", ctypes.c_uint32),
        ("tetrahedron_count", ctypes.c_uint64),
        ("skipped_count", ctypes.c_uint64),
        ("inverted_count", ctypes.c_uint64),
        ("face_count", ctypes.c_uint64),
        ("boundary_face_count", ctypes.c_uint64),
        ("crowded_face_count", ctypes.c_uint64),
        ("bytes", ctypes.c_uint64),
        ("build_seconds", ctypes.c_double),
    ]


class kiwami_tetrahedron_location(ctypes.Structure):
    _fields_ = [
        ("tetrahedron_id", ctypes.c_uint32),
        ("weights", ctypes.c_float * 4),
    ]


class kiwami_user_hit(ctypes.Structure):
    _fields_ = [
        ("t", ctypes.c_float),
        ("u", ctypes.c_float),
        ("v", ctypes.c_float),
        ("normal_x", ctypes.c_float),
        ("normal_y", ctypes.c_float),
        ("normal_z", ctypes.c_float),
        ("primitive_id", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_user_intersection(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("primitive_count", ctypes.c_uint32),
        ("primitive_ids", ctypes.c_void_p),
        ("ray", ctypes.c_void_p),
        ("geometry_id", ctypes.c_uint32),
        ("hit_capacity", ctypes.c_uint32),
        ("hits", ctypes.c_void_p),
        ("hit_count", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


class kiwami_user_geometry_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("count", ctypes.c_uint64),
        ("bounds", ctypes.c_void_p),
        ("intersect", ctypes.c_void_p),
        ("destroy", ctypes.c_void_p),
        ("user", ctypes.c_void_p),
        ("mask", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]


SIZES = {
    kiwami_device_desc: 88,
    kiwami_device_info: 56,
    kiwami_triangle_mesh_desc: 80,
    kiwami_scene_info: 176,
    kiwami_instances_desc: 88,
    kiwami_ray: 48,
    kiwami_hit: 36,
    kiwami_input_field: 16,
    kiwami_output_field: 16,
    kiwami_ray_fields: 184,
    kiwami_hit_fields: 152,
    kiwami_exclusion: 12,
    kiwami_filter_candidate: 88,
    kiwami_query: 72,
    kiwami_bvh_node: 56,
    kiwami_bvh_primitive: 8,
    kiwami_bvh_info: 56,
    kiwami_parameter_value: 16,
    kiwami_bvh_desc: 72,
    kiwami_bvh_measure_desc: 32,
    kiwami_bvh_measures: 48,
    kiwami_bvh_node_measures: 24,
    kiwami_visits: 48,
    kiwami_ray_visits: 8,
    kiwami_binary_tree_info: 64,
    kiwami_binary_visits: 32,
    kiwami_distribution_desc: 32,
    kiwami_distribution_info: 48,
    kiwami_draw: 16,
    kiwami_binary_node: 32,
    kiwami_wide4_node: 128,
    kiwami_wide8_node: 256,
    kiwami_compressed8_node: 80,
    kiwami_light: 96,
    kiwami_light_mesh_desc: 96,
    kiwami_light_instance_desc: 72,
    kiwami_light_tree_desc: 24,
    kiwami_light_tree_info: 64,
    kiwami_light_receiver: 56,
    kiwami_light_choice: 24,
    kiwami_light_name: 8,
    kiwami_light_lobe: 16,
    kiwami_light_pixel: 12,
    kiwami_light_query: 72,
    kiwami_save_desc: 48,
    kiwami_load_desc: 56,
    kiwami_file_info: 56,
    kiwami_moving_mesh_desc: 96,
    kiwami_quaternion_transform: 64,
    kiwami_moving_instances_desc: 112,
    kiwami_opacity_desc: 56,
    kiwami_spheres_desc: 48,
    kiwami_discs_desc: 72,
    kiwami_curves_desc: 80,
    kiwami_interpolation: 184,
    kiwami_tetrahedra_desc: 56,
    kiwami_tetrahedra_info: 72,
    kiwami_tetrahedron_location: 20,
    kiwami_user_hit: 32,
    kiwami_user_intersection: 48,
    kiwami_user_geometry_desc: 56,
}


def declare(library):
    """Gives the functions of a loaded library their signatures."""
    library.kiwami_version.restype = ctypes.c_uint32
    library.kiwami_version.argtypes = []
    library.kiwami_abi_version.restype = ctypes.c_uint32
    library.kiwami_abi_version.argtypes = []
    library.kiwami_result_name.restype = ctypes.c_char_p
    library.kiwami_result_name.argtypes = [ctypes.c_int32]
    library.kiwami_last_error.restype = ctypes.c_size_t
    library.kiwami_last_error.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_device_desc_init.restype = ctypes.c_int32
    library.kiwami_device_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_device_create.restype = ctypes.c_int32
    library.kiwami_device_create.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_device_retain.restype = None
    library.kiwami_device_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_device_release.restype = None
    library.kiwami_device_release.argtypes = [ctypes.c_void_p]
    library.kiwami_device_get_info.restype = ctypes.c_int32
    library.kiwami_device_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_isa_name.restype = ctypes.c_char_p
    library.kiwami_isa_name.argtypes = [ctypes.c_uint32]
    library.kiwami_triangle_mesh_desc_init.restype = ctypes.c_int32
    library.kiwami_triangle_mesh_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_triangle_mesh_create.restype = ctypes.c_int32
    library.kiwami_triangle_mesh_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_triangle_mesh_update_vertices.restype = ctypes.c_int32
    library.kiwami_triangle_mesh_update_vertices.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_uint64,
        ctypes.c_uint64,
    ]
    library.kiwami_geometry_set_mask.restype = ctypes.c_int32
    library.kiwami_geometry_set_mask.argtypes = [ctypes.c_void_p, ctypes.c_uint32]
    library.kiwami_geometry_retain.restype = None
    library.kiwami_geometry_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_geometry_release.restype = None
    library.kiwami_geometry_release.argtypes = [ctypes.c_void_p]
    library.kiwami_scene_create.restype = ctypes.c_int32
    library.kiwami_scene_create.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_scene_retain.restype = None
    library.kiwami_scene_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_scene_release.restype = None
    library.kiwami_scene_release.argtypes = [ctypes.c_void_p]
    library.kiwami_scene_attach.restype = ctypes.c_int32
    library.kiwami_scene_attach.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_scene_detach.restype = ctypes.c_int32
    library.kiwami_scene_detach.argtypes = [ctypes.c_void_p, ctypes.c_uint32]
    library.kiwami_scene_replace.restype = ctypes.c_int32
    library.kiwami_scene_replace.argtypes = [ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p]
    library.kiwami_scene_enable.restype = ctypes.c_int32
    library.kiwami_scene_enable.argtypes = [ctypes.c_void_p, ctypes.c_uint32, ctypes.c_int32]
    library.kiwami_scene_set_parameter.restype = ctypes.c_int32
    library.kiwami_scene_set_parameter.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_double,
    ]
    library.kiwami_parameter_bounds.restype = ctypes.c_int32
    library.kiwami_parameter_bounds.argtypes = [
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_scene_set_representative_rays.restype = ctypes.c_int32
    library.kiwami_scene_set_representative_rays.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
    ]
    library.kiwami_scene_set_optimizers.restype = ctypes.c_int32
    library.kiwami_scene_set_optimizers.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_quality_methods.restype = ctypes.c_int32
    library.kiwami_quality_methods.argtypes = [
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_method_name.restype = ctypes.c_char_p
    library.kiwami_method_name.argtypes = [ctypes.c_uint32, ctypes.c_uint32]
    library.kiwami_scene_set_progress.restype = ctypes.c_int32
    library.kiwami_scene_set_progress.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_scene_commit.restype = ctypes.c_int32
    library.kiwami_scene_commit.argtypes = [ctypes.c_void_p]
    library.kiwami_scene_refit.restype = ctypes.c_int32
    library.kiwami_scene_refit.argtypes = [ctypes.c_void_p]
    library.kiwami_scene_get_info.restype = ctypes.c_int32
    library.kiwami_scene_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_scene_validate.restype = ctypes.c_int32
    library.kiwami_scene_validate.argtypes = [ctypes.c_void_p]
    library.kiwami_instances_desc_init.restype = ctypes.c_int32
    library.kiwami_instances_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_instances_create.restype = ctypes.c_int32
    library.kiwami_instances_create.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_ray_fields_init.restype = ctypes.c_int32
    library.kiwami_ray_fields_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_hit_fields_init.restype = ctypes.c_int32
    library.kiwami_hit_fields_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_query_init.restype = ctypes.c_int32
    library.kiwami_query_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_closest_hit.restype = ctypes.c_int32
    library.kiwami_closest_hit.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_any_hit.restype = ctypes.c_int32
    library.kiwami_any_hit.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_closest_hit_fields.restype = ctypes.c_int32
    library.kiwami_closest_hit_fields.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_any_hit_fields.restype = ctypes.c_int32
    library.kiwami_any_hit_fields.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_multi_hit.restype = ctypes.c_int32
    library.kiwami_multi_hit.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_uint64,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_count_hits.restype = ctypes.c_int32
    library.kiwami_count_hits.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_multi_hit_fields.restype = ctypes.c_int32
    library.kiwami_multi_hit_fields.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_uint64,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_count_hits_fields.restype = ctypes.c_int32
    library.kiwami_count_hits_fields.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_scene_get_bvh.restype = ctypes.c_int32
    library.kiwami_scene_get_bvh.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_bvh_desc_init.restype = ctypes.c_int32
    library.kiwami_bvh_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_bvh_build.restype = ctypes.c_int32
    library.kiwami_bvh_build.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_bvh_refit.restype = ctypes.c_int32
    library.kiwami_bvh_refit.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
    ]
    library.kiwami_bvh_validate.restype = ctypes.c_int32
    library.kiwami_bvh_validate.argtypes = [ctypes.c_void_p]
    library.kiwami_bvh_retain.restype = None
    library.kiwami_bvh_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_bvh_release.restype = None
    library.kiwami_bvh_release.argtypes = [ctypes.c_void_p]
    library.kiwami_bvh_get_info.restype = ctypes.c_int32
    library.kiwami_bvh_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_bvh_get_nodes.restype = ctypes.c_int32
    library.kiwami_bvh_get_nodes.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_bvh_get_primitives.restype = ctypes.c_int32
    library.kiwami_bvh_get_primitives.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_bvh_measure_desc_init.restype = ctypes.c_int32
    library.kiwami_bvh_measure_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_bvh_measure.restype = ctypes.c_int32
    library.kiwami_bvh_measure.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_scene_count_visits.restype = ctypes.c_int32
    library.kiwami_scene_count_visits.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_binary_tree_create.restype = ctypes.c_int32
    library.kiwami_binary_tree_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_void_p,
    ]
    library.kiwami_binary_tree_retain.restype = None
    library.kiwami_binary_tree_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_binary_tree_release.restype = None
    library.kiwami_binary_tree_release.argtypes = [ctypes.c_void_p]
    library.kiwami_binary_tree_get_info.restype = ctypes.c_int32
    library.kiwami_binary_tree_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_binary_tree_validate.restype = ctypes.c_int32
    library.kiwami_binary_tree_validate.argtypes = [ctypes.c_void_p]
    library.kiwami_binary_tree_closest_hit.restype = ctypes.c_int32
    library.kiwami_binary_tree_closest_hit.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_distribution_desc_init.restype = ctypes.c_int32
    library.kiwami_distribution_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_distribution_create.restype = ctypes.c_int32
    library.kiwami_distribution_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_distribution_retain.restype = None
    library.kiwami_distribution_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_distribution_release.restype = None
    library.kiwami_distribution_release.argtypes = [ctypes.c_void_p]
    library.kiwami_distribution_get_info.restype = ctypes.c_int32
    library.kiwami_distribution_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_distribution_sample.restype = ctypes.c_int32
    library.kiwami_distribution_sample.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
    ]
    library.kiwami_distribution_pdf.restype = ctypes.c_int32
    library.kiwami_distribution_pdf.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
    ]
    library.kiwami_bvh_export_counts.restype = ctypes.c_int32
    library.kiwami_bvh_export_counts.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_bvh_export.restype = ctypes.c_int32
    library.kiwami_bvh_export.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_light_tree_desc_init.restype = ctypes.c_int32
    library.kiwami_light_tree_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_light_mesh_desc_init.restype = ctypes.c_int32
    library.kiwami_light_mesh_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_light_instance_desc_init.restype = ctypes.c_int32
    library.kiwami_light_instance_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_light_query_init.restype = ctypes.c_int32
    library.kiwami_light_query_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_light_tree_create.restype = ctypes.c_int32
    library.kiwami_light_tree_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_light_tree_retain.restype = None
    library.kiwami_light_tree_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_light_tree_release.restype = None
    library.kiwami_light_tree_release.argtypes = [ctypes.c_void_p]
    library.kiwami_light_tree_add_lights.restype = ctypes.c_int32
    library.kiwami_light_tree_add_lights.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_light_tree_add_mesh.restype = ctypes.c_int32
    library.kiwami_light_tree_add_mesh.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_light_tree_add_instance.restype = ctypes.c_int32
    library.kiwami_light_tree_add_instance.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_light_tree_set_lights.restype = ctypes.c_int32
    library.kiwami_light_tree_set_lights.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
    ]
    library.kiwami_light_tree_set_powers.restype = ctypes.c_int32
    library.kiwami_light_tree_set_powers.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
    ]
    library.kiwami_light_tree_set_instance.restype = ctypes.c_int32
    library.kiwami_light_tree_set_instance.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_void_p,
    ]
    library.kiwami_light_tree_commit.restype = ctypes.c_int32
    library.kiwami_light_tree_commit.argtypes = [ctypes.c_void_p]
    library.kiwami_light_tree_refit.restype = ctypes.c_int32
    library.kiwami_light_tree_refit.argtypes = [ctypes.c_void_p]
    library.kiwami_light_tree_get_info.restype = ctypes.c_int32
    library.kiwami_light_tree_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_light_sample.restype = ctypes.c_int32
    library.kiwami_light_sample.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_light_pdf.restype = ctypes.c_int32
    library.kiwami_light_pdf.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.kiwami_save_desc_init.restype = ctypes.c_int32
    library.kiwami_save_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_load_desc_init.restype = ctypes.c_int32
    library.kiwami_load_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_scene_save.restype = ctypes.c_int32
    library.kiwami_scene_save.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_scene_load.restype = ctypes.c_int32
    library.kiwami_scene_load.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_bvh_save.restype = ctypes.c_int32
    library.kiwami_bvh_save.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_bvh_load.restype = ctypes.c_int32
    library.kiwami_bvh_load.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_light_tree_save.restype = ctypes.c_int32
    library.kiwami_light_tree_save.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_light_tree_load.restype = ctypes.c_int32
    library.kiwami_light_tree_load.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_file_get_info.restype = ctypes.c_int32
    library.kiwami_file_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_moving_mesh_desc_init.restype = ctypes.c_int32
    library.kiwami_moving_mesh_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_moving_mesh_create.restype = ctypes.c_int32
    library.kiwami_moving_mesh_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_moving_instances_desc_init.restype = ctypes.c_int32
    library.kiwami_moving_instances_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_moving_instances_create.restype = ctypes.c_int32
    library.kiwami_moving_instances_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_instances_transform.restype = ctypes.c_int32
    library.kiwami_instances_transform.argtypes = [
        ctypes.c_void_p,
        ctypes.c_uint64,
        ctypes.c_float,
        ctypes.c_void_p,
    ]
    library.kiwami_opacity_desc_init.restype = ctypes.c_int32
    library.kiwami_opacity_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_triangle_mesh_set_opacity.restype = ctypes.c_int32
    library.kiwami_triangle_mesh_set_opacity.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_opacity_micro_triangle.restype = ctypes.c_uint32
    library.kiwami_opacity_micro_triangle.argtypes = [
        ctypes.c_float,
        ctypes.c_float,
        ctypes.c_uint32,
    ]
    library.kiwami_spheres_desc_init.restype = ctypes.c_int32
    library.kiwami_spheres_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_discs_desc_init.restype = ctypes.c_int32
    library.kiwami_discs_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_curves_desc_init.restype = ctypes.c_int32
    library.kiwami_curves_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_spheres_create.restype = ctypes.c_int32
    library.kiwami_spheres_create.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_discs_create.restype = ctypes.c_int32
    library.kiwami_discs_create.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_curves_create.restype = ctypes.c_int32
    library.kiwami_curves_create.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_interpolation_init.restype = ctypes.c_int32
    library.kiwami_interpolation_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_interpolate.restype = ctypes.c_int32
    library.kiwami_interpolate.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_hit_points.restype = ctypes.c_int32
    library.kiwami_hit_points.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_offset_origins.restype = ctypes.c_int32
    library.kiwami_offset_origins.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    library.kiwami_tetrahedra_desc_init.restype = ctypes.c_int32
    library.kiwami_tetrahedra_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_tetrahedra_create.restype = ctypes.c_int32
    library.kiwami_tetrahedra_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.kiwami_tetrahedra_retain.restype = None
    library.kiwami_tetrahedra_retain.argtypes = [ctypes.c_void_p]
    library.kiwami_tetrahedra_release.restype = None
    library.kiwami_tetrahedra_release.argtypes = [ctypes.c_void_p]
    library.kiwami_tetrahedra_get_info.restype = ctypes.c_int32
    library.kiwami_tetrahedra_get_info.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.kiwami_tetrahedra_locate.restype = ctypes.c_int32
    library.kiwami_tetrahedra_locate.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_size_t,
    ]
    library.kiwami_user_geometry_desc_init.restype = ctypes.c_int32
    library.kiwami_user_geometry_desc_init.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.kiwami_user_geometry_create.restype = ctypes.c_int32
    library.kiwami_user_geometry_create.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
