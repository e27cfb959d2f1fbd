// SPDX-License-Identifier: Apache-2.0
//! The C interface of Kiwami. Generated from the headers by
//! bindings/schema/generate.py; do not edit. See the crate `kiwami` for a safe one.
#![allow(non_camel_case_types)]
#![cfg_attr(rustfmt, rustfmt_skip)]

use std::os::raw::{c_char, c_void};

pub type kiwami_result = i32;

pub const KIWAMI_ABI_VERSION: u32 = 0;
pub const KIWAMI_FILE_FORMAT_VERSION: u32 = 2;
pub const KIWAMI_INVALID_ID: u32 = 4294967295;
pub const KIWAMI_LIGHT_MAX_CHOICES: u32 = 64;
pub const KIWAMI_MAX_COORDINATE: f32 = 1.152921504606847e+18;
pub const KIWAMI_MAX_INSTANCE_DEPTH: u32 = 8;
pub const KIWAMI_OPACITY_ALL_OPAQUE: u32 = 4294967293;
pub const KIWAMI_OPACITY_ALL_TRANSPARENT: u32 = 4294967292;
pub const KIWAMI_OPACITY_ALL_UNKNOWN_OPAQUE: u32 = 4294967295;
pub const KIWAMI_OPACITY_ALL_UNKNOWN_TRANSPARENT: u32 = 4294967294;
pub const KIWAMI_VERSION_MAJOR: u32 = 0;
pub const KIWAMI_VERSION_MINOR: u32 = 1;
pub const KIWAMI_VERSION_PATCH: u32 = 0;
pub const KIWAMI_OK: i32 = 0;
pub const KIWAMI_ERROR_INVALID_ARGUMENT: i32 = -1;
pub const KIWAMI_ERROR_INVALID_STATE: i32 = -2;
pub const KIWAMI_ERROR_OUT_OF_MEMORY: i32 = -3;
pub const KIWAMI_ERROR_UNSUPPORTED_ISA: i32 = -4;
pub const KIWAMI_ERROR_TOO_LARGE: i32 = -5;
pub const KIWAMI_ERROR_CALLBACK: i32 = -6;
pub const KIWAMI_ERROR_VALIDATION: i32 = -7;
pub const KIWAMI_ERROR_INTERNAL: i32 = -8;
pub const KIWAMI_ERROR_CAPACITY: i32 = -9;
pub const KIWAMI_ERROR_INVALID_FILE: i32 = -10;
pub const KIWAMI_ERROR_IO: i32 = -11;
pub const KIWAMI_ERROR_CANCELLED: i32 = -12;
pub const KIWAMI_ISA_AUTO: u32 = 0;
pub const KIWAMI_ISA_SCALAR: u32 = 1;
pub const KIWAMI_ISA_SSE: u32 = 2;
pub const KIWAMI_ISA_AVX2: u32 = 3;
pub const KIWAMI_ISA_AVX512: u32 = 4;
pub const KIWAMI_DEVICE_VALIDATE: u32 = 1;
pub const KIWAMI_MESH_SHARE_BUFFERS: u32 = 1;
pub const KIWAMI_PARAMETER_BVH_WIDTH: u32 = 1;
pub const KIWAMI_PARAMETER_MERGE_LEAVES: u32 = 2;
pub const KIWAMI_PARAMETER_MERGE_RING: u32 = 3;
pub const KIWAMI_PARAMETER_BIN_COUNT: u32 = 4;
pub const KIWAMI_PARAMETER_MAX_LEAF_SIZE: u32 = 5;
pub const KIWAMI_PARAMETER_NODE_COST: u32 = 6;
pub const KIWAMI_PARAMETER_LEAF_COST: u32 = 7;
pub const KIWAMI_PARAMETER_VALIDATE_BUILD: u32 = 8;
pub const KIWAMI_PARAMETER_CONTRACTION: u32 = 9;
pub const KIWAMI_PARAMETER_BUILDER: u32 = 10;
pub const KIWAMI_PARAMETER_SPLIT_BUDGET: u32 = 11;
pub const KIWAMI_PARAMETER_SPLIT_ALPHA: u32 = 12;
pub const KIWAMI_PARAMETER_BIN_HALVING: u32 = 13;
pub const KIWAMI_PARAMETER_REASSIGN: u32 = 14;
pub const KIWAMI_PARAMETER_AAC_QUALITY: u32 = 17;
pub const KIWAMI_PARAMETER_CURVE_CODE: u32 = 18;
pub const KIWAMI_PARAMETER_LBVH_DELTA: u32 = 19;
pub const KIWAMI_PARAMETER_LBVH_CHUNK_SIZE: u32 = 20;
pub const KIWAMI_PARAMETER_LAYOUT: u32 = 21;
pub const KIWAMI_PARAMETER_QUALITY: u32 = 30;
pub const KIWAMI_PARAMETER_REBRAID: u32 = 40;
pub const KIWAMI_PARAMETER_REBRAID_BUDGET: u32 = 41;
pub const KIWAMI_PARAMETER_TWO_LEVEL: u32 = 42;
pub const KIWAMI_PARAMETER_DIVIDE_TIME: u32 = 43;
pub const KIWAMI_REBRAID_OFF: u32 = 0;
pub const KIWAMI_REBRAID_FULL: u32 = 1;
pub const KIWAMI_REBRAID_ROOTS: u32 = 2;
pub const KIWAMI_LAYOUT_FAST: u32 = 0;
pub const KIWAMI_LAYOUT_COMPACT: u32 = 1;
pub const KIWAMI_STAGE_BUILDER: u32 = 1;
pub const KIWAMI_STAGE_OPTIMIZER: u32 = 2;
pub const KIWAMI_STAGE_CONTRACTION: u32 = 3;
pub const KIWAMI_QUALITY_BALANCED: u32 = 0;
pub const KIWAMI_QUALITY_FAST: u32 = 1;
pub const KIWAMI_QUALITY_BEST: u32 = 2;
pub const KIWAMI_BUILDER_BINNED_SAH: u32 = 0;
pub const KIWAMI_BUILDER_LBVH: u32 = 1;
pub const KIWAMI_BUILDER_PLOC: u32 = 2;
pub const KIWAMI_BUILDER_SWEEP_SAH: u32 = 3;
pub const KIWAMI_BUILDER_SPATIAL_SPLIT: u32 = 4;
pub const KIWAMI_BUILDER_AGGLOMERATIVE: u32 = 5;
pub const KIWAMI_BUILDER_AAC: u32 = 6;
pub const KIWAMI_BUILDER_MINI_TREE: u32 = 7;
pub const KIWAMI_BUILDER_OIBVH: u32 = 8;
pub const KIWAMI_BUILDER_WIDE_BOTTOM_UP: u32 = 9;
pub const KIWAMI_BUILDER_STR: u32 = 10;
pub const KIWAMI_BUILDER_TRBVH: u32 = 11;
pub const KIWAMI_BUILDER_WIDE_TOP_DOWN: u32 = 12;
pub const KIWAMI_BUILDER_WIDE_LINEAR: u32 = 13;
pub const KIWAMI_BUILDER_TRIAL: u32 = 14;
pub const KIWAMI_OPTIMIZER_PARALLEL_REINSERTION: u32 = 1;
pub const KIWAMI_OPTIMIZER_ROTATION: u32 = 2;
pub const KIWAMI_OPTIMIZER_TREELET: u32 = 3;
pub const KIWAMI_OPTIMIZER_AGGLOMERATIVE_TREELET: u32 = 4;
pub const KIWAMI_OPTIMIZER_REINSERTION: u32 = 5;
pub const KIWAMI_OPTIMIZER_REORDER_SATO: u32 = 6;
pub const KIWAMI_OPTIMIZER_REORDER_NARY: u32 = 7;
pub const KIWAMI_CONTRACTION_SURFACE_AREA: u32 = 0;
pub const KIWAMI_CONTRACTION_OPTIMAL: u32 = 1;
pub const KIWAMI_CONTRACTION_RAY_DISTRIBUTION: u32 = 2;
pub const KIWAMI_MAX_OPTIMIZERS: u32 = 8;
pub const KIWAMI_INSTANCES_SHARE_BUFFERS: u32 = 1;
pub const KIWAMI_RAY_CULL_BACK_FACES: u32 = 1;
pub const KIWAMI_RAY_CULL_FRONT_FACES: u32 = 2;
pub const KIWAMI_FILTER_REJECT: u32 = 0;
pub const KIWAMI_FILTER_ACCEPT: u32 = 1;
pub const KIWAMI_FILTER_ACCEPT_AND_STOP: u32 = 2;
pub const KIWAMI_QUERY_CALLING_THREAD: u32 = 1;
pub const KIWAMI_MEASURE_WITHOUT_EPO: u32 = 1;
pub const KIWAMI_COUNT_CLOSEST_HIT: u32 = 0;
pub const KIWAMI_COUNT_ANY_HIT: u32 = 1;
pub const KIWAMI_BINARY_LAYOUT_BOXES: u32 = 0;
pub const KIWAMI_BINARY_LAYOUT_DUAL_SPLIT: u32 = 1;
pub const KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST: u32 = 0;
pub const KIWAMI_DISTRIBUTION_ALIAS_TABLE: u32 = 1;
pub const KIWAMI_EXPORT_BINARY: u32 = 1;
pub const KIWAMI_EXPORT_WIDE4: u32 = 2;
pub const KIWAMI_EXPORT_WIDE8: u32 = 3;
pub const KIWAMI_EXPORT_COMPRESSED8: u32 = 4;
pub const KIWAMI_LIGHT_POINT: u32 = 0;
pub const KIWAMI_LIGHT_SPOT: u32 = 1;
pub const KIWAMI_LIGHT_TRIANGLE: u32 = 2;
pub const KIWAMI_LIGHT_QUAD: u32 = 3;
pub const KIWAMI_LIGHT_SPHERE: u32 = 4;
pub const KIWAMI_LIGHT_DISC: u32 = 5;
pub const KIWAMI_LIGHT_DISTANT: u32 = 6;
pub const KIWAMI_LIGHT_ENVIRONMENT: u32 = 7;
pub const KIWAMI_LIGHT_TWO_SIDED: u32 = 1;
pub const KIWAMI_LIGHT_BUILDER_SAOH: u32 = 0;
pub const KIWAMI_LIGHT_BUILDER_OCTANTS: u32 = 1;
pub const KIWAMI_LIGHT_TREE_WITH_ROULETTE: u32 = 1;
pub const KIWAMI_RECEIVER_BOTH_SIDES: u32 = 1;
pub const KIWAMI_LIGHT_METHOD_TREE: u32 = 0;
pub const KIWAMI_LIGHT_METHOD_POWER: u32 = 1;
pub const KIWAMI_LIGHT_METHOD_TREE_SPLITTING: u32 = 2;
pub const KIWAMI_LIGHT_METHOD_LIGHTCUTS: u32 = 3;
pub const KIWAMI_LIGHT_METHOD_LAZY_ROULETTE: u32 = 4;
pub const KIWAMI_LIGHT_METHOD_CULLING: u32 = 5;
pub const KIWAMI_LIGHT_METHOD_ROULETTE: u32 = 6;
pub const KIWAMI_LIGHT_LOBE_COSINE: u32 = 0;
pub const KIWAMI_LIGHT_LOBE_TANGENT_SPHERE: u32 = 1;
pub const KIWAMI_LIGHT_LOBE_GLOSSY: u32 = 2;
pub const KIWAMI_LIGHT_ORDER_XOR: u32 = 0;
pub const KIWAMI_LIGHT_ORDER_SCRAMBLED: u32 = 1;
pub const KIWAMI_LIGHT_SEQUENCE_RANDOM: u32 = 0;
pub const KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE: u32 = 1;
pub const KIWAMI_LIGHT_QUERY_CALLING_THREAD: u32 = 1;
pub const KIWAMI_LOAD_MAP: u32 = 1;
pub const KIWAMI_LOAD_TRUSTED: u32 = 2;
pub const KIWAMI_FILE_SCENE: u32 = 1;
pub const KIWAMI_FILE_BVH: u32 = 2;
pub const KIWAMI_FILE_LIGHTS: u32 = 3;
pub const KIWAMI_FIT_NATIVE: u32 = 0;
pub const KIWAMI_FIT_SCALAR: u32 = 1;
pub const KIWAMI_FIT_NONE: u32 = 2;
pub const KIWAMI_MOVING_MESH_SHARE_BUFFERS: u32 = 1;
pub const KIWAMI_MAX_TIME_STEPS: u32 = 129;
pub const KIWAMI_TRANSFORM_MATRIX: u32 = 0;
pub const KIWAMI_TRANSFORM_QUATERNION: u32 = 1;
pub const KIWAMI_OPACITY_TRANSPARENT: u32 = 0;
pub const KIWAMI_OPACITY_OPAQUE: u32 = 1;
pub const KIWAMI_OPACITY_UNKNOWN_TRANSPARENT: u32 = 2;
pub const KIWAMI_OPACITY_UNKNOWN_OPAQUE: u32 = 3;
pub const KIWAMI_OPACITY_2_STATES: u32 = 1;
pub const KIWAMI_OPACITY_4_STATES: u32 = 2;
pub const KIWAMI_OPACITY_MAX_LEVEL: u32 = 6;
pub const KIWAMI_SHAPES_SHARE_BUFFERS: u32 = 1;
pub const KIWAMI_TETRAHEDRA_BOXES: u32 = 0;
pub const KIWAMI_TETRAHEDRA_FACES: u32 = 1;
pub const KIWAMI_USER_HITS_PER_PRIMITIVE: u32 = 4;

#[repr(C)]
pub struct kiwami_binary_tree {
    _private: [u8; 0],
}

#[repr(C)]
pub struct kiwami_bvh {
    _private: [u8; 0],
}

#[repr(C)]
pub struct kiwami_device {
    _private: [u8; 0],
}

#[repr(C)]
pub struct kiwami_distribution {
    _private: [u8; 0],
}

#[repr(C)]
pub struct kiwami_geometry {
    _private: [u8; 0],
}

#[repr(C)]
pub struct kiwami_light_tree {
    _private: [u8; 0],
}

#[repr(C)]
pub struct kiwami_scene {
    _private: [u8; 0],
}

#[repr(C)]
pub struct kiwami_tetrahedra {
    _private: [u8; 0],
}

pub type kiwami_parallel_task =
    Option<unsafe extern "C" fn(task_data: *mut c_void, index: usize)>;

pub type kiwami_parallel_runner =
    Option<unsafe extern "C" fn(user: *mut c_void, count: usize, task: kiwami_parallel_task, task_data: *mut c_void) -> i32>;

pub type kiwami_allocate =
    Option<unsafe extern "C" fn(user: *mut c_void, size: usize, alignment: usize) -> *mut c_void>;

pub type kiwami_deallocate =
    Option<unsafe extern "C" fn(user: *mut c_void, memory: *mut c_void, size: usize, alignment: usize)>;

pub type kiwami_log =
    Option<unsafe extern "C" fn(user: *mut c_void, severity: kiwami_result, sentence: *const c_char)>;

pub type kiwami_progress =
    Option<unsafe extern "C" fn(user: *mut c_void, fraction: f64) -> i32>;

pub type kiwami_filter_function =
    Option<unsafe extern "C" fn(user: *mut c_void, candidate: *const kiwami_filter_candidate) -> i32>;

pub type kiwami_write =
    Option<unsafe extern "C" fn(user: *mut c_void, data: *const c_void, size: usize) -> i32>;

pub type kiwami_read =
    Option<unsafe extern "C" fn(user: *mut c_void, data: *mut c_void, size: usize) -> i64>;

pub type kiwami_user_bounds_function =
    Option<unsafe extern "C" fn(user: *mut c_void, first: u32, count: u32, bounds: *mut f32) -> i32>;

pub type kiwami_user_intersect_function =
    Option<unsafe extern "C" fn(user: *mut c_void, intersection: *mut kiwami_user_intersection) -> i32>;

pub type kiwami_user_destroy_function =
    Option<unsafe extern "C" fn(user: *mut c_void)>;

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_device_desc {
    pub struct_size: u32,
    pub isa: u32,
    pub thread_count: u32,
    pub flags: u32,
    pub runner: kiwami_parallel_runner,
    pub runner_user: *mut c_void,
    pub runner_width: u32,
    pub reserved: u32,
    pub allocate: kiwami_allocate,
    pub deallocate: kiwami_deallocate,
    pub allocator_user: *mut c_void,
    pub log: kiwami_log,
    pub log_user: *mut c_void,
    pub memory_limit: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_device_desc>() == 88);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_device_info {
    pub struct_size: u32,
    pub isa: u32,
    pub isa_available: u32,
    pub isa_built: u32,
    pub native_widths: u32,
    pub default_bvh_width: u32,
    pub thread_count: u32,
    pub reserved: u32,
    pub memory_bytes: u64,
    pub memory_peak_bytes: u64,
    pub memory_limit: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_device_info>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_triangle_mesh_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub vertices: *const c_void,
    pub vertex_offset: u64,
    pub vertex_stride: u64,
    pub vertex_count: u64,
    pub indices: *const c_void,
    pub index_offset: u64,
    pub index_stride: u64,
    pub triangle_count: u64,
    pub mask: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_triangle_mesh_desc>() == 80);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_scene_info {
    pub struct_size: u32,
    pub bvh_width: u32,
    pub leaf_width: u32,
    pub bvh_depth: u32,
    pub triangle_count: u64,
    pub skipped_count: u64,
    pub node_count: u64,
    pub leaf_block_count: u64,
    pub node_bytes: u64,
    pub leaf_bytes: u64,
    pub total_bytes: u64,
    pub peak_build_bytes: u64,
    pub node_fill: f64,
    pub leaf_fill: f64,
    pub sah_cost: f64,
    pub build_seconds: f64,
    pub bounds_min: [f32; 3],
    pub bounds_max: [f32; 3],
    pub reference_count: u64,
    pub refit_count: u64,
    pub instance_count: u64,
    pub instance_tree_bytes: u64,
    pub instance_depth: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_scene_info>() == 176);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_instances_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub scenes: *mut *mut kiwami_scene,
    pub scene_count: u64,
    pub scene_indices: *const c_void,
    pub scene_index_stride: u64,
    pub transforms: *const c_void,
    pub transform_stride: u64,
    pub count: u64,
    pub masks: *const c_void,
    pub mask_stride: u64,
    pub mask: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_instances_desc>() == 88);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_ray {
    pub origin_x: f32,
    pub origin_y: f32,
    pub origin_z: f32,
    pub tmin: f32,
    pub direction_x: f32,
    pub direction_y: f32,
    pub direction_z: f32,
    pub tmax: f32,
    pub time: f32,
    pub mask: u32,
    pub flags: u32,
    pub id: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_ray>() == 48);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_hit {
    pub t: f32,
    pub u: f32,
    pub v: f32,
    pub normal_x: f32,
    pub normal_y: f32,
    pub normal_z: f32,
    pub primitive_id: u32,
    pub geometry_id: u32,
    pub instance_id: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_hit>() == 36);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_input_field {
    pub data: *const c_void,
    pub stride: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_input_field>() == 16);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_output_field {
    pub data: *mut c_void,
    pub stride: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_output_field>() == 16);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_ray_fields {
    pub struct_size: u32,
    pub reserved: u32,
    pub origin_x: kiwami_input_field,
    pub origin_y: kiwami_input_field,
    pub origin_z: kiwami_input_field,
    pub direction_x: kiwami_input_field,
    pub direction_y: kiwami_input_field,
    pub direction_z: kiwami_input_field,
    pub tmin: kiwami_input_field,
    pub tmax: kiwami_input_field,
    pub time: kiwami_input_field,
    pub mask: kiwami_input_field,
    pub flags: kiwami_input_field,
}
const _: () = assert!(std::mem::size_of::<kiwami_ray_fields>() == 184);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_hit_fields {
    pub struct_size: u32,
    pub reserved: u32,
    pub t: kiwami_output_field,
    pub u: kiwami_output_field,
    pub v: kiwami_output_field,
    pub normal_x: kiwami_output_field,
    pub normal_y: kiwami_output_field,
    pub normal_z: kiwami_output_field,
    pub primitive_id: kiwami_output_field,
    pub geometry_id: kiwami_output_field,
    pub instance_id: kiwami_output_field,
}
const _: () = assert!(std::mem::size_of::<kiwami_hit_fields>() == 152);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_exclusion {
    pub primitive_id: u32,
    pub geometry_id: u32,
    pub instance_id: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_exclusion>() == 12);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_filter_candidate {
    pub struct_size: u32,
    pub depth: u32,
    pub ray: u64,
    pub hit: kiwami_hit,
    pub reserved: u32,
    pub instance_path: [u32; 8],
}
const _: () = assert!(std::mem::size_of::<kiwami_filter_candidate>() == 88);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_query {
    pub struct_size: u32,
    pub flags: u32,
    pub instance_paths: *mut u32,
    pub instance_path_stride: u64,
    pub exclusions: *const kiwami_exclusion,
    pub exclusion_stride: u64,
    pub exclusion_paths: *const u32,
    pub exclusion_path_stride: u64,
    pub filter: kiwami_filter_function,
    pub filter_user: *mut c_void,
}
const _: () = assert!(std::mem::size_of::<kiwami_query>() == 72);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_bvh_node {
    pub lower: [f32; 3],
    pub upper: [f32; 3],
    pub parent: u32,
    pub depth: u32,
    pub first_child: u32,
    pub child_count: u32,
    pub first_primitive: u32,
    pub primitive_count: u32,
    pub storage_index: u32,
    pub storage_mask: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_bvh_node>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_bvh_primitive {
    pub geometry_id: u32,
    pub primitive_id: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_bvh_primitive>() == 8);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_bvh_info {
    pub struct_size: u32,
    pub width: u32,
    pub leaf_width: u32,
    pub depth: u32,
    pub node_count: u32,
    pub leaf_count: u32,
    pub primitive_count: u32,
    pub reserved: u32,
    pub bytes: u64,
    pub skipped_count: u64,
    pub build_seconds: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_bvh_info>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_parameter_value {
    pub parameter: u32,
    pub reserved: u32,
    pub value: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_parameter_value>() == 16);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_bvh_desc {
    pub struct_size: u32,
    pub width: u32,
    pub boxes: *const c_void,
    pub box_stride: u64,
    pub box_count: u64,
    pub geometry: *mut kiwami_geometry,
    pub parameters: *const kiwami_parameter_value,
    pub parameter_count: u64,
    pub optimizers: *const u32,
    pub optimizer_count: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_bvh_desc>() == 72);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_bvh_measure_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub node_cost: f64,
    pub leaf_cost: f64,
    pub block_size: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_bvh_measure_desc>() == 32);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_bvh_measures {
    pub struct_size: u32,
    pub reserved: u32,
    pub sah: f64,
    pub epo: f64,
    pub node_area: f64,
    pub leaf_area: f64,
    pub surface_area: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_bvh_measures>() == 48);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_bvh_node_measures {
    pub area: f64,
    pub sah: f64,
    pub epo: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_bvh_node_measures>() == 24);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_visits {
    pub struct_size: u32,
    pub reserved: u32,
    pub ray_count: u64,
    pub hit_count: u64,
    pub node_visits: u64,
    pub leaf_visits: u64,
    pub leaf_count_variability: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_visits>() == 48);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_ray_visits {
    pub node_visits: u32,
    pub leaf_visits: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_ray_visits>() == 8);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_binary_tree_info {
    pub struct_size: u32,
    pub layout: u32,
    pub node_count: u64,
    pub split_count: u64,
    pub carve_count: u64,
    pub leaf_count: u64,
    pub primitive_count: u64,
    pub node_bytes: u64,
    pub bytes: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_binary_tree_info>() == 64);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_binary_visits {
    pub struct_size: u32,
    pub reserved: u32,
    pub node_visits: u64,
    pub plane_tests: u64,
    pub leaf_visits: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_binary_visits>() == 32);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_distribution_desc {
    pub struct_size: u32,
    pub method: u32,
    pub weights: *const c_void,
    pub weight_stride: u64,
    pub weight_count: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_distribution_desc>() == 32);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_distribution_info {
    pub struct_size: u32,
    pub method: u32,
    pub weight_count: u64,
    pub bytes: u64,
    pub total: f64,
    pub mean_steps: f64,
    pub most_steps: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_distribution_info>() == 48);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_draw {
    pub index: u32,
    pub probability: f32,
    pub random: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_draw>() == 16);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_binary_node {
    pub lower: [f32; 3],
    pub first: u32,
    pub upper: [f32; 3],
    pub count: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_binary_node>() == 32);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_wide4_node {
    pub lower_x: [f32; 4],
    pub lower_y: [f32; 4],
    pub lower_z: [f32; 4],
    pub upper_x: [f32; 4],
    pub upper_y: [f32; 4],
    pub upper_z: [f32; 4],
    pub child: [u32; 4],
    pub count: [u32; 4],
}
const _: () = assert!(std::mem::size_of::<kiwami_wide4_node>() == 128);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_wide8_node {
    pub lower_x: [f32; 8],
    pub lower_y: [f32; 8],
    pub lower_z: [f32; 8],
    pub upper_x: [f32; 8],
    pub upper_y: [f32; 8],
    pub upper_z: [f32; 8],
    pub child: [u32; 8],
    pub count: [u32; 8],
}
const _: () = assert!(std::mem::size_of::<kiwami_wide8_node>() == 256);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_compressed8_node {
    pub origin: [f32; 3],
    pub exponent: [u8; 3],
    pub inner_mask: u8,
    pub child_base: u32,
    pub primitive_base: u32,
    pub meta: [u8; 8],
    pub lower_x: [u8; 8],
    pub lower_y: [u8; 8],
    pub lower_z: [u8; 8],
    pub upper_x: [u8; 8],
    pub upper_y: [u8; 8],
    pub upper_z: [u8; 8],
}
const _: () = assert!(std::mem::size_of::<kiwami_compressed8_node>() == 80);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light {
    pub r#type: u32,
    pub flags: u32,
    pub points: [f32; 12],
    pub direction: [f32; 3],
    pub radius: f32,
    pub cos_inner: f32,
    pub cos_outer: f32,
    pub power: f32,
    pub user_id: u32,
    pub link_mask: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_light>() == 96);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_mesh_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub vertices: *const c_void,
    pub vertex_stride: u64,
    pub vertex_count: u64,
    pub indices: *const c_void,
    pub index_stride: u64,
    pub triangle_count: u64,
    pub radiances: *const c_void,
    pub radiance_stride: u64,
    pub link_mask: u64,
    pub radiance: f32,
    pub user_id: u32,
    pub user_id_step: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_mesh_desc>() == 96);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_instance_desc {
    pub struct_size: u32,
    pub power_scale: f32,
    pub tree: *mut kiwami_light_tree,
    pub local_to_world: [f32; 12],
    pub link_mask: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_instance_desc>() == 72);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_tree_desc {
    pub struct_size: u32,
    pub width: u32,
    pub builder: u32,
    pub distant_probability: f32,
    pub flags: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_tree_desc>() == 24);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_tree_info {
    pub struct_size: u32,
    pub width: u32,
    pub light_count: u32,
    pub instance_count: u32,
    pub distant_count: u32,
    pub node_count: u32,
    pub depth: u32,
    pub reserved: u32,
    pub bytes: u64,
    pub power: f64,
    pub cost: f64,
    pub build_seconds: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_tree_info>() == 64);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_receiver {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    pub segment: [f32; 3],
    pub flags: u32,
    pub link_mask: u64,
    pub random: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_receiver>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_choice {
    pub light_id: u32,
    pub instance_id: u32,
    pub user_id: u32,
    pub probability: f32,
    pub random: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_choice>() == 24);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_name {
    pub light_id: u32,
    pub instance_id: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_name>() == 8);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_lobe {
    pub axis: [f32; 3],
    pub roughness: f32,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_lobe>() == 16);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_pixel {
    pub x: u32,
    pub y: u32,
    pub sample: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_pixel>() == 12);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_light_query {
    pub struct_size: u32,
    pub flags: u32,
    pub method: u32,
    pub max_choices: u32,
    pub threshold: f32,
    pub lobe: u32,
    pub order: u32,
    pub reach: f32,
    pub lobes: *const kiwami_light_lobe,
    pub lobe_stride: u64,
    pub sequence: u32,
    pub sequence_seed: u32,
    pub pixels: *const kiwami_light_pixel,
    pub pixel_stride: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_light_query>() == 72);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_save_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub path: *const c_char,
    pub write: kiwami_write,
    pub write_user: *mut c_void,
    pub data: *mut c_void,
    pub capacity: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_save_desc>() == 48);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_load_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub path: *const c_char,
    pub read: kiwami_read,
    pub read_user: *mut c_void,
    pub data: *const c_void,
    pub size: u64,
    pub bvh_width: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_load_desc>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_file_info {
    pub struct_size: u32,
    pub kind: u32,
    pub fit: u32,
    pub format_version: u32,
    pub library_version: u32,
    pub bvh_width: u32,
    pub section_count: u32,
    pub reserved: u32,
    pub file_bytes: u64,
    pub triangle_count: u64,
    pub node_count: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_file_info>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_moving_mesh_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub vertices: *const c_void,
    pub vertex_offset: u64,
    pub vertex_stride: u64,
    pub vertex_count: u64,
    pub step_stride: u64,
    pub indices: *const c_void,
    pub index_offset: u64,
    pub index_stride: u64,
    pub triangle_count: u64,
    pub step_count: u32,
    pub time_begin: f32,
    pub time_end: f32,
    pub mask: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_moving_mesh_desc>() == 96);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_quaternion_transform {
    pub scale_x: f32,
    pub scale_y: f32,
    pub scale_z: f32,
    pub skew_xy: f32,
    pub skew_xz: f32,
    pub skew_yz: f32,
    pub shift_x: f32,
    pub shift_y: f32,
    pub shift_z: f32,
    pub quaternion_r: f32,
    pub quaternion_i: f32,
    pub quaternion_j: f32,
    pub quaternion_k: f32,
    pub translation_x: f32,
    pub translation_y: f32,
    pub translation_z: f32,
}
const _: () = assert!(std::mem::size_of::<kiwami_quaternion_transform>() == 64);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_moving_instances_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub scenes: *mut *mut kiwami_scene,
    pub scene_count: u64,
    pub scene_indices: *const c_void,
    pub scene_index_stride: u64,
    pub transforms: *const c_void,
    pub transform_stride: u64,
    pub step_stride: u64,
    pub count: u64,
    pub masks: *const c_void,
    pub mask_stride: u64,
    pub format: u32,
    pub step_count: u32,
    pub time_begin: f32,
    pub time_end: f32,
    pub mask: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_moving_instances_desc>() == 112);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_opacity_desc {
    pub struct_size: u32,
    pub format: u32,
    pub level: u32,
    pub reserved: u32,
    pub maps: *const c_void,
    pub map_stride: u64,
    pub map_count: u64,
    pub indices: *const c_void,
    pub index_stride: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_opacity_desc>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_spheres_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub points: *const c_void,
    pub point_offset: u64,
    pub point_stride: u64,
    pub sphere_count: u64,
    pub mask: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_spheres_desc>() == 48);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_discs_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub points: *const c_void,
    pub point_offset: u64,
    pub point_stride: u64,
    pub normals: *const c_void,
    pub normal_offset: u64,
    pub normal_stride: u64,
    pub disc_count: u64,
    pub mask: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_discs_desc>() == 72);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_curves_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub points: *const c_void,
    pub point_offset: u64,
    pub point_stride: u64,
    pub point_count: u64,
    pub indices: *const c_void,
    pub index_offset: u64,
    pub index_stride: u64,
    pub segment_count: u64,
    pub mask: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_curves_desc>() == 80);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_interpolation {
    pub struct_size: u32,
    pub channels: u32,
    pub attributes: *const c_void,
    pub attribute_offset: u64,
    pub attribute_stride: u64,
    pub attribute_count: u64,
    pub indices: *const c_void,
    pub index_offset: u64,
    pub index_stride: u64,
    pub primitive_id: kiwami_input_field,
    pub u: kiwami_input_field,
    pub v: kiwami_input_field,
    pub geometry_id: kiwami_input_field,
    pub geometry: u32,
    pub reserved: u32,
    pub values: *mut c_void,
    pub value_stride: u64,
    pub derivatives_u: *mut c_void,
    pub derivative_u_stride: u64,
    pub derivatives_v: *mut c_void,
    pub derivative_v_stride: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_interpolation>() == 184);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_tetrahedra_desc {
    pub struct_size: u32,
    pub method: u32,
    pub vertices: *const c_void,
    pub vertex_stride: u64,
    pub vertex_count: u64,
    pub indices: *const c_void,
    pub index_stride: u64,
    pub tetrahedron_count: u64,
}
const _: () = assert!(std::mem::size_of::<kiwami_tetrahedra_desc>() == 56);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_tetrahedra_info {
    pub struct_size: u32,
    pub method: u32,
    pub tetrahedron_count: u64,
    pub skipped_count: u64,
    pub inverted_count: u64,
    pub face_count: u64,
    pub boundary_face_count: u64,
    pub crowded_face_count: u64,
    pub bytes: u64,
    pub build_seconds: f64,
}
const _: () = assert!(std::mem::size_of::<kiwami_tetrahedra_info>() == 72);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_tetrahedron_location {
    pub tetrahedron_id: u32,
    pub weights: [f32; 4],
}
const _: () = assert!(std::mem::size_of::<kiwami_tetrahedron_location>() == 20);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_user_hit {
    pub t: f32,
    pub u: f32,
    pub v: f32,
    pub normal_x: f32,
    pub normal_y: f32,
    pub normal_z: f32,
    pub primitive_id: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_user_hit>() == 32);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_user_intersection {
    pub struct_size: u32,
    pub primitive_count: u32,
    pub primitive_ids: *const u32,
    pub ray: *const kiwami_ray,
    pub geometry_id: u32,
    pub hit_capacity: u32,
    pub hits: *mut kiwami_user_hit,
    pub hit_count: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_user_intersection>() == 48);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct kiwami_user_geometry_desc {
    pub struct_size: u32,
    pub flags: u32,
    pub count: u64,
    pub bounds: kiwami_user_bounds_function,
    pub intersect: kiwami_user_intersect_function,
    pub destroy: kiwami_user_destroy_function,
    pub user: *mut c_void,
    pub mask: u32,
    pub reserved: u32,
}
const _: () = assert!(std::mem::size_of::<kiwami_user_geometry_desc>() == 56);

extern "C" {
    pub fn kiwami_version() -> u32;
    pub fn kiwami_abi_version() -> u32;
    pub fn kiwami_result_name(result: kiwami_result) -> *const c_char;
    pub fn kiwami_last_error(device: *const kiwami_device, text: *mut c_char, capacity: usize) -> usize;
    pub fn kiwami_device_desc_init(desc: *mut kiwami_device_desc, size: usize) -> kiwami_result;
    pub fn kiwami_device_create(desc: *const kiwami_device_desc, device: *mut *mut kiwami_device) -> kiwami_result;
    pub fn kiwami_device_retain(device: *mut kiwami_device);
    pub fn kiwami_device_release(device: *mut kiwami_device);
    pub fn kiwami_device_get_info(device: *const kiwami_device, info: *mut kiwami_device_info) -> kiwami_result;
    pub fn kiwami_isa_name(isa: u32) -> *const c_char;
    pub fn kiwami_triangle_mesh_desc_init(desc: *mut kiwami_triangle_mesh_desc, size: usize) -> kiwami_result;
    pub fn kiwami_triangle_mesh_create(device: *mut kiwami_device, desc: *const kiwami_triangle_mesh_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_triangle_mesh_update_vertices(geometry: *mut kiwami_geometry, vertices: *const c_void, vertex_offset: u64, vertex_stride: u64) -> kiwami_result;
    pub fn kiwami_geometry_set_mask(geometry: *mut kiwami_geometry, mask: u32) -> kiwami_result;
    pub fn kiwami_geometry_retain(geometry: *mut kiwami_geometry);
    pub fn kiwami_geometry_release(geometry: *mut kiwami_geometry);
    pub fn kiwami_scene_create(device: *mut kiwami_device, scene: *mut *mut kiwami_scene) -> kiwami_result;
    pub fn kiwami_scene_retain(scene: *mut kiwami_scene);
    pub fn kiwami_scene_release(scene: *mut kiwami_scene);
    pub fn kiwami_scene_attach(scene: *mut kiwami_scene, geometry: *mut kiwami_geometry, geometry_id: *mut u32) -> kiwami_result;
    pub fn kiwami_scene_detach(scene: *mut kiwami_scene, geometry_id: u32) -> kiwami_result;
    pub fn kiwami_scene_replace(scene: *mut kiwami_scene, geometry_id: u32, geometry: *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_scene_enable(scene: *mut kiwami_scene, geometry_id: u32, is_enabled: i32) -> kiwami_result;
    pub fn kiwami_scene_set_parameter(scene: *mut kiwami_scene, parameter: u32, value: f64) -> kiwami_result;
    pub fn kiwami_parameter_bounds(parameter: u32, lowest: *mut f64, highest: *mut f64, preset: *mut f64) -> kiwami_result;
    pub fn kiwami_scene_set_representative_rays(scene: *mut kiwami_scene, rays: *const kiwami_ray, stride: usize, count: usize) -> kiwami_result;
    pub fn kiwami_scene_set_optimizers(scene: *mut kiwami_scene, methods: *const u32, count: usize) -> kiwami_result;
    pub fn kiwami_quality_methods(quality: u32, builder: *mut u32, optimizers: *mut u32, optimizer_count: *mut usize, contraction: *mut u32) -> kiwami_result;
    pub fn kiwami_method_name(stage: u32, method: u32) -> *const c_char;
    pub fn kiwami_scene_set_progress(scene: *mut kiwami_scene, function: kiwami_progress, user: *mut c_void) -> kiwami_result;
    pub fn kiwami_scene_commit(scene: *mut kiwami_scene) -> kiwami_result;
    pub fn kiwami_scene_refit(scene: *mut kiwami_scene) -> kiwami_result;
    pub fn kiwami_scene_get_info(scene: *const kiwami_scene, info: *mut kiwami_scene_info) -> kiwami_result;
    pub fn kiwami_scene_validate(scene: *const kiwami_scene) -> kiwami_result;
    pub fn kiwami_instances_desc_init(desc: *mut kiwami_instances_desc, size: usize) -> kiwami_result;
    pub fn kiwami_instances_create(device: *mut kiwami_device, desc: *const kiwami_instances_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_ray_fields_init(rays: *mut kiwami_ray_fields, size: usize) -> kiwami_result;
    pub fn kiwami_hit_fields_init(hits: *mut kiwami_hit_fields, size: usize) -> kiwami_result;
    pub fn kiwami_query_init(query: *mut kiwami_query, size: usize) -> kiwami_result;
    pub fn kiwami_closest_hit(scene: *const kiwami_scene, rays: *const kiwami_ray, ray_stride: usize, hits: *mut kiwami_hit, hit_stride: usize, count: usize, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_any_hit(scene: *const kiwami_scene, rays: *const kiwami_ray, ray_stride: usize, occluded: *mut u8, stride: usize, count: usize, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_closest_hit_fields(scene: *const kiwami_scene, rays: *const kiwami_ray_fields, hits: *const kiwami_hit_fields, count: usize, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_any_hit_fields(scene: *const kiwami_scene, rays: *const kiwami_ray_fields, occluded: *const kiwami_output_field, count: usize, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_multi_hit(scene: *const kiwami_scene, rays: *const kiwami_ray, ray_stride: usize, count: usize, max_hits: u32, hits: *mut kiwami_hit, hit_capacity: u64, offsets: *mut u64, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_count_hits(scene: *const kiwami_scene, rays: *const kiwami_ray, ray_stride: usize, counts: *mut u32, stride: usize, count: usize, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_multi_hit_fields(scene: *const kiwami_scene, rays: *const kiwami_ray_fields, count: usize, max_hits: u32, hits: *const kiwami_hit_fields, hit_capacity: u64, offsets: *mut u64, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_count_hits_fields(scene: *const kiwami_scene, rays: *const kiwami_ray_fields, counts: *const kiwami_output_field, count: usize, query: *const kiwami_query) -> kiwami_result;
    pub fn kiwami_scene_get_bvh(scene: *const kiwami_scene, bvh: *mut *mut kiwami_bvh) -> kiwami_result;
    pub fn kiwami_bvh_desc_init(desc: *mut kiwami_bvh_desc, size: usize) -> kiwami_result;
    pub fn kiwami_bvh_build(device: *mut kiwami_device, desc: *const kiwami_bvh_desc, bvh: *mut *mut kiwami_bvh) -> kiwami_result;
    pub fn kiwami_bvh_refit(bvh: *mut kiwami_bvh, boxes: *const c_void, stride: usize, count: usize) -> kiwami_result;
    pub fn kiwami_bvh_validate(bvh: *const kiwami_bvh) -> kiwami_result;
    pub fn kiwami_bvh_retain(bvh: *mut kiwami_bvh);
    pub fn kiwami_bvh_release(bvh: *mut kiwami_bvh);
    pub fn kiwami_bvh_get_info(bvh: *const kiwami_bvh, info: *mut kiwami_bvh_info) -> kiwami_result;
    pub fn kiwami_bvh_get_nodes(bvh: *const kiwami_bvh, first: usize, count: usize, nodes: *mut kiwami_bvh_node, stride: usize) -> kiwami_result;
    pub fn kiwami_bvh_get_primitives(bvh: *const kiwami_bvh, first: usize, count: usize, primitives: *mut kiwami_bvh_primitive, stride: usize) -> kiwami_result;
    pub fn kiwami_bvh_measure_desc_init(desc: *mut kiwami_bvh_measure_desc, size: usize) -> kiwami_result;
    pub fn kiwami_bvh_measure(bvh: *const kiwami_bvh, desc: *const kiwami_bvh_measure_desc, measures: *mut kiwami_bvh_measures, nodes: *mut kiwami_bvh_node_measures, stride: usize) -> kiwami_result;
    pub fn kiwami_scene_count_visits(scene: *const kiwami_scene, rays: *const kiwami_ray, ray_stride: usize, count: usize, query: u32, visits: *mut kiwami_visits, each: *mut kiwami_ray_visits, each_stride: usize) -> kiwami_result;
    pub fn kiwami_binary_tree_create(bvh: *const kiwami_bvh, layout: u32, tree: *mut *mut kiwami_binary_tree) -> kiwami_result;
    pub fn kiwami_binary_tree_retain(tree: *mut kiwami_binary_tree);
    pub fn kiwami_binary_tree_release(tree: *mut kiwami_binary_tree);
    pub fn kiwami_binary_tree_get_info(tree: *const kiwami_binary_tree, info: *mut kiwami_binary_tree_info) -> kiwami_result;
    pub fn kiwami_binary_tree_validate(tree: *const kiwami_binary_tree) -> kiwami_result;
    pub fn kiwami_binary_tree_closest_hit(tree: *const kiwami_binary_tree, rays: *const kiwami_ray, ray_stride: usize, hits: *mut kiwami_hit, hit_stride: usize, count: usize, visits: *mut kiwami_binary_visits) -> kiwami_result;
    pub fn kiwami_distribution_desc_init(desc: *mut kiwami_distribution_desc, size: usize) -> kiwami_result;
    pub fn kiwami_distribution_create(device: *mut kiwami_device, desc: *const kiwami_distribution_desc, distribution: *mut *mut kiwami_distribution) -> kiwami_result;
    pub fn kiwami_distribution_retain(distribution: *mut kiwami_distribution);
    pub fn kiwami_distribution_release(distribution: *mut kiwami_distribution);
    pub fn kiwami_distribution_get_info(distribution: *const kiwami_distribution, info: *mut kiwami_distribution_info) -> kiwami_result;
    pub fn kiwami_distribution_sample(distribution: *const kiwami_distribution, randoms: *const f64, random_stride: usize, draws: *mut kiwami_draw, draw_stride: usize, count: usize) -> kiwami_result;
    pub fn kiwami_distribution_pdf(distribution: *const kiwami_distribution, indices: *const u32, index_stride: usize, probabilities: *mut f32, probability_stride: usize, count: usize) -> kiwami_result;
    pub fn kiwami_bvh_export_counts(bvh: *const kiwami_bvh, format: u32, node_count: *mut usize, primitive_count: *mut usize) -> kiwami_result;
    pub fn kiwami_bvh_export(bvh: *const kiwami_bvh, format: u32, nodes: *mut c_void, node_bytes: usize, primitives: *mut kiwami_bvh_primitive, primitive_count: usize) -> kiwami_result;
    pub fn kiwami_light_tree_desc_init(desc: *mut kiwami_light_tree_desc, size: usize) -> kiwami_result;
    pub fn kiwami_light_mesh_desc_init(desc: *mut kiwami_light_mesh_desc, size: usize) -> kiwami_result;
    pub fn kiwami_light_instance_desc_init(desc: *mut kiwami_light_instance_desc, size: usize) -> kiwami_result;
    pub fn kiwami_light_query_init(query: *mut kiwami_light_query, size: usize) -> kiwami_result;
    pub fn kiwami_light_tree_create(device: *mut kiwami_device, desc: *const kiwami_light_tree_desc, tree: *mut *mut kiwami_light_tree) -> kiwami_result;
    pub fn kiwami_light_tree_retain(tree: *mut kiwami_light_tree);
    pub fn kiwami_light_tree_release(tree: *mut kiwami_light_tree);
    pub fn kiwami_light_tree_add_lights(tree: *mut kiwami_light_tree, lights: *const kiwami_light, stride: usize, count: usize, first_id: *mut u32) -> kiwami_result;
    pub fn kiwami_light_tree_add_mesh(tree: *mut kiwami_light_tree, desc: *const kiwami_light_mesh_desc, first_id: *mut u32) -> kiwami_result;
    pub fn kiwami_light_tree_add_instance(tree: *mut kiwami_light_tree, desc: *const kiwami_light_instance_desc, instance_id: *mut u32) -> kiwami_result;
    pub fn kiwami_light_tree_set_lights(tree: *mut kiwami_light_tree, first: u32, lights: *const kiwami_light, stride: usize, count: usize) -> kiwami_result;
    pub fn kiwami_light_tree_set_powers(tree: *mut kiwami_light_tree, first: u32, powers: *const f32, stride: usize, count: usize) -> kiwami_result;
    pub fn kiwami_light_tree_set_instance(tree: *mut kiwami_light_tree, instance_id: u32, desc: *const kiwami_light_instance_desc) -> kiwami_result;
    pub fn kiwami_light_tree_commit(tree: *mut kiwami_light_tree) -> kiwami_result;
    pub fn kiwami_light_tree_refit(tree: *mut kiwami_light_tree) -> kiwami_result;
    pub fn kiwami_light_tree_get_info(tree: *const kiwami_light_tree, info: *mut kiwami_light_tree_info) -> kiwami_result;
    pub fn kiwami_light_sample(tree: *const kiwami_light_tree, receivers: *const kiwami_light_receiver, receiver_stride: usize, choices: *mut kiwami_light_choice, choice_stride: usize, count: usize, query: *const kiwami_light_query) -> kiwami_result;
    pub fn kiwami_light_pdf(tree: *const kiwami_light_tree, receivers: *const kiwami_light_receiver, receiver_stride: usize, lights: *const kiwami_light_name, light_stride: usize, probabilities: *mut f32, probability_stride: usize, count: usize, query: *const kiwami_light_query) -> kiwami_result;
    pub fn kiwami_save_desc_init(desc: *mut kiwami_save_desc, size: usize) -> kiwami_result;
    pub fn kiwami_load_desc_init(desc: *mut kiwami_load_desc, size: usize) -> kiwami_result;
    pub fn kiwami_scene_save(scene: *const kiwami_scene, desc: *const kiwami_save_desc, bytes: *mut u64) -> kiwami_result;
    pub fn kiwami_scene_load(device: *mut kiwami_device, desc: *const kiwami_load_desc, scene: *mut *mut kiwami_scene) -> kiwami_result;
    pub fn kiwami_bvh_save(bvh: *const kiwami_bvh, desc: *const kiwami_save_desc, bytes: *mut u64) -> kiwami_result;
    pub fn kiwami_bvh_load(device: *mut kiwami_device, desc: *const kiwami_load_desc, bvh: *mut *mut kiwami_bvh) -> kiwami_result;
    pub fn kiwami_light_tree_save(tree: *const kiwami_light_tree, desc: *const kiwami_save_desc, bytes: *mut u64) -> kiwami_result;
    pub fn kiwami_light_tree_load(device: *mut kiwami_device, desc: *const kiwami_load_desc, tree: *mut *mut kiwami_light_tree) -> kiwami_result;
    pub fn kiwami_file_get_info(device: *mut kiwami_device, desc: *const kiwami_load_desc, info: *mut kiwami_file_info) -> kiwami_result;
    pub fn kiwami_moving_mesh_desc_init(desc: *mut kiwami_moving_mesh_desc, size: usize) -> kiwami_result;
    pub fn kiwami_moving_mesh_create(device: *mut kiwami_device, desc: *const kiwami_moving_mesh_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_moving_instances_desc_init(desc: *mut kiwami_moving_instances_desc, size: usize) -> kiwami_result;
    pub fn kiwami_moving_instances_create(device: *mut kiwami_device, desc: *const kiwami_moving_instances_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_instances_transform(instances: *const kiwami_geometry, instance: u64, time: f32, transform: *mut f32) -> kiwami_result;
    pub fn kiwami_opacity_desc_init(desc: *mut kiwami_opacity_desc, size: usize) -> kiwami_result;
    pub fn kiwami_triangle_mesh_set_opacity(mesh: *mut kiwami_geometry, desc: *const kiwami_opacity_desc) -> kiwami_result;
    pub fn kiwami_opacity_micro_triangle(u: f32, v: f32, level: u32) -> u32;
    pub fn kiwami_spheres_desc_init(desc: *mut kiwami_spheres_desc, size: usize) -> kiwami_result;
    pub fn kiwami_discs_desc_init(desc: *mut kiwami_discs_desc, size: usize) -> kiwami_result;
    pub fn kiwami_curves_desc_init(desc: *mut kiwami_curves_desc, size: usize) -> kiwami_result;
    pub fn kiwami_spheres_create(device: *mut kiwami_device, desc: *const kiwami_spheres_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_discs_create(device: *mut kiwami_device, desc: *const kiwami_discs_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_curves_create(device: *mut kiwami_device, desc: *const kiwami_curves_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
    pub fn kiwami_interpolation_init(interpolation: *mut kiwami_interpolation, size: usize) -> kiwami_result;
    pub fn kiwami_interpolate(mesh: *const kiwami_geometry, interpolation: *const kiwami_interpolation, count: usize) -> kiwami_result;
    pub fn kiwami_hit_points(scene: *const kiwami_scene, hits: *const kiwami_hit, hit_stride: usize, count: usize, points: *mut f32, point_stride: usize, errors: *mut f32, error_stride: usize) -> kiwami_result;
    pub fn kiwami_offset_origins(scene: *const kiwami_scene, hits: *const kiwami_hit, hit_stride: usize, directions: *const f32, direction_stride: usize, count: usize, origins: *mut f32, origin_stride: usize) -> kiwami_result;
    pub fn kiwami_tetrahedra_desc_init(desc: *mut kiwami_tetrahedra_desc, size: usize) -> kiwami_result;
    pub fn kiwami_tetrahedra_create(device: *mut kiwami_device, desc: *const kiwami_tetrahedra_desc, tetrahedra: *mut *mut kiwami_tetrahedra) -> kiwami_result;
    pub fn kiwami_tetrahedra_retain(tetrahedra: *mut kiwami_tetrahedra);
    pub fn kiwami_tetrahedra_release(tetrahedra: *mut kiwami_tetrahedra);
    pub fn kiwami_tetrahedra_get_info(tetrahedra: *const kiwami_tetrahedra, info: *mut kiwami_tetrahedra_info) -> kiwami_result;
    pub fn kiwami_tetrahedra_locate(tetrahedra: *const kiwami_tetrahedra, points: *const c_void, point_stride: usize, locations: *mut kiwami_tetrahedron_location, location_stride: usize, count: usize) -> kiwami_result;
    pub fn kiwami_user_geometry_desc_init(desc: *mut kiwami_user_geometry_desc, size: usize) -> kiwami_result;
    pub fn kiwami_user_geometry_create(device: *mut kiwami_device, desc: *const kiwami_user_geometry_desc, geometry: *mut *mut kiwami_geometry) -> kiwami_result;
}
