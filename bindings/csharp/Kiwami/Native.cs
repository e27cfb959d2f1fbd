// SPDX-License-Identifier: Apache-2.0
// The C interface for P/Invoke. Generated from the headers by
// bindings/schema/generate.py; do not edit.
#pragma warning disable 649
using System;
using System.Runtime.InteropServices;

namespace Kiwami.Interop {

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate void kiwami_parallel_task(IntPtr task_data, UIntPtr index);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate int kiwami_parallel_runner(IntPtr user, UIntPtr count, IntPtr task, IntPtr task_data);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate IntPtr kiwami_allocate(IntPtr user, UIntPtr size, UIntPtr alignment);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate void kiwami_deallocate(IntPtr user, IntPtr memory, UIntPtr size, UIntPtr alignment);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate void kiwami_log(IntPtr user, int severity, IntPtr sentence);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate int kiwami_progress(IntPtr user, double fraction);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate int kiwami_filter_function(IntPtr user, IntPtr candidate);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate int kiwami_write(IntPtr user, IntPtr data, UIntPtr size);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate long kiwami_read(IntPtr user, IntPtr data, UIntPtr size);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate int kiwami_user_bounds_function(IntPtr user, uint first, uint count, IntPtr bounds);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate int kiwami_user_intersect_function(IntPtr user, IntPtr intersection);

[UnmanagedFunctionPointer(CallingConvention.Cdecl)]
internal delegate void kiwami_user_destroy_function(IntPtr user);

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_device_desc {
  public uint struct_size;
  public uint isa;
  public uint thread_count;
  public uint flags;
  public IntPtr runner;
  public IntPtr runner_user;
  public uint runner_width;
  public uint reserved;
  public IntPtr allocate;
  public IntPtr deallocate;
  public IntPtr allocator_user;
  public IntPtr log;
  public IntPtr log_user;
  public ulong memory_limit;
  public const int Size = 88;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_device_info {
  public uint struct_size;
  public uint isa;
  public uint isa_available;
  public uint isa_built;
  public uint native_widths;
  public uint default_bvh_width;
  public uint thread_count;
  public uint reserved;
  public ulong memory_bytes;
  public ulong memory_peak_bytes;
  public ulong memory_limit;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_triangle_mesh_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr vertices;
  public ulong vertex_offset;
  public ulong vertex_stride;
  public ulong vertex_count;
  public IntPtr indices;
  public ulong index_offset;
  public ulong index_stride;
  public ulong triangle_count;
  public uint mask;
  public uint reserved;
  public const int Size = 80;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_scene_info {
  public uint struct_size;
  public uint bvh_width;
  public uint leaf_width;
  public uint bvh_depth;
  public ulong triangle_count;
  public ulong skipped_count;
  public ulong node_count;
  public ulong leaf_block_count;
  public ulong node_bytes;
  public ulong leaf_bytes;
  public ulong total_bytes;
  public ulong peak_build_bytes;
  public double node_fill;
  public double leaf_fill;
  public double sah_cost;
  public double build_seconds;
  public fixed float bounds_min[3];
  public fixed float bounds_max[3];
  public ulong reference_count;
  public ulong refit_count;
  public ulong instance_count;
  public ulong instance_tree_bytes;
  public uint instance_depth;
  public uint reserved;
  public const int Size = 176;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_instances_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr scenes;
  public ulong scene_count;
  public IntPtr scene_indices;
  public ulong scene_index_stride;
  public IntPtr transforms;
  public ulong transform_stride;
  public ulong count;
  public IntPtr masks;
  public ulong mask_stride;
  public uint mask;
  public uint reserved;
  public const int Size = 88;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_ray {
  public float origin_x;
  public float origin_y;
  public float origin_z;
  public float tmin;
  public float direction_x;
  public float direction_y;
  public float direction_z;
  public float tmax;
  public float time;
  public uint mask;
  public uint flags;
  public uint id;
  public const int Size = 48;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_hit {
  public float t;
  public float u;
  public float v;
  public float normal_x;
  public float normal_y;
  public float normal_z;
  public uint primitive_id;
  public uint geometry_id;
  public uint instance_id;
  public const int Size = 36;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_input_field {
  public IntPtr data;
  public ulong stride;
  public const int Size = 16;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_output_field {
  public IntPtr data;
  public ulong stride;
  public const int Size = 16;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_ray_fields {
  public uint struct_size;
  public uint reserved;
  public kiwami_input_field origin_x;
  public kiwami_input_field origin_y;
  public kiwami_input_field origin_z;
  public kiwami_input_field direction_x;
  public kiwami_input_field direction_y;
  public kiwami_input_field direction_z;
  public kiwami_input_field tmin;
  public kiwami_input_field tmax;
  public kiwami_input_field time;
  public kiwami_input_field mask;
  public kiwami_input_field flags;
  public const int Size = 184;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_hit_fields {
  public uint struct_size;
  public uint reserved;
  public kiwami_output_field t;
  public kiwami_output_field u;
  public kiwami_output_field v;
  public kiwami_output_field normal_x;
  public kiwami_output_field normal_y;
  public kiwami_output_field normal_z;
  public kiwami_output_field primitive_id;
  public kiwami_output_field geometry_id;
  public kiwami_output_field instance_id;
  public const int Size = 152;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_exclusion {
  public uint primitive_id;
  public uint geometry_id;
  public uint instance_id;
  public const int Size = 12;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_filter_candidate {
  public uint struct_size;
  public uint depth;
  public ulong ray;
  public kiwami_hit hit;
  public uint reserved;
  public fixed uint instance_path[8];
  public const int Size = 88;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_query {
  public uint struct_size;
  public uint flags;
  public IntPtr instance_paths;
  public ulong instance_path_stride;
  public IntPtr exclusions;
  public ulong exclusion_stride;
  public IntPtr exclusion_paths;
  public ulong exclusion_path_stride;
  public IntPtr filter;
  public IntPtr filter_user;
  public const int Size = 72;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_bvh_node {
  public fixed float lower[3];
  public fixed float upper[3];
  public uint parent;
  public uint depth;
  public uint first_child;
  public uint child_count;
  public uint first_primitive;
  public uint primitive_count;
  public uint storage_index;
  public uint storage_mask;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_bvh_primitive {
  public uint geometry_id;
  public uint primitive_id;
  public const int Size = 8;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_bvh_info {
  public uint struct_size;
  public uint width;
  public uint leaf_width;
  public uint depth;
  public uint node_count;
  public uint leaf_count;
  public uint primitive_count;
  public uint reserved;
  public ulong bytes;
  public ulong skipped_count;
  public double build_seconds;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_parameter_value {
  public uint parameter;
  public uint reserved;
  public double value;
  public const int Size = 16;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_bvh_desc {
  public uint struct_size;
  public uint width;
  public IntPtr boxes;
  public ulong box_stride;
  public ulong box_count;
  public IntPtr geometry;
  public IntPtr parameters;
  public ulong parameter_count;
  public IntPtr optimizers;
  public ulong optimizer_count;
  public const int Size = 72;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_bvh_measure_desc {
  public uint struct_size;
  public uint flags;
  public double node_cost;
  public double leaf_cost;
  public uint block_size;
  public uint reserved;
  public const int Size = 32;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_bvh_measures {
  public uint struct_size;
  public uint reserved;
  public double sah;
  public double epo;
  public double node_area;
  public double leaf_area;
  public double surface_area;
  public const int Size = 48;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_bvh_node_measures {
  public double area;
  public double sah;
  public double epo;
  public const int Size = 24;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_visits {
  public uint struct_size;
  public uint reserved;
  public ulong ray_count;
  public ulong hit_count;
  public ulong node_visits;
  public ulong leaf_visits;
  public double leaf_count_variability;
  public const int Size = 48;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_ray_visits {
  public uint node_visits;
  public uint leaf_visits;
  public const int Size = 8;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_binary_tree_info {
  public uint struct_size;
  public uint layout;
  public ulong node_count;
  public ulong split_count;
  public ulong carve_count;
  public ulong leaf_count;
  public ulong primitive_count;
  public ulong node_bytes;
  public ulong bytes;
  public const int Size = 64;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_binary_visits {
  public uint struct_size;
  public uint reserved;
  public ulong node_visits;
  public ulong plane_tests;
  public ulong leaf_visits;
  public const int Size = 32;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_distribution_desc {
  public uint struct_size;
  public uint method;
  public IntPtr weights;
  public ulong weight_stride;
  public ulong weight_count;
  public const int Size = 32;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_distribution_info {
  public uint struct_size;
  public uint method;
  public ulong weight_count;
  public ulong bytes;
  public double total;
  public double mean_steps;
  public uint most_steps;
  public uint reserved;
  public const int Size = 48;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_draw {
  public uint index;
  public float probability;
  public double random;
  public const int Size = 16;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_binary_node {
  public fixed float lower[3];
  public uint first;
  public fixed float upper[3];
  public uint count;
  public const int Size = 32;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_wide4_node {
  public fixed float lower_x[4];
  public fixed float lower_y[4];
  public fixed float lower_z[4];
  public fixed float upper_x[4];
  public fixed float upper_y[4];
  public fixed float upper_z[4];
  public fixed uint child[4];
  public fixed uint count[4];
  public const int Size = 128;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_wide8_node {
  public fixed float lower_x[8];
  public fixed float lower_y[8];
  public fixed float lower_z[8];
  public fixed float upper_x[8];
  public fixed float upper_y[8];
  public fixed float upper_z[8];
  public fixed uint child[8];
  public fixed uint count[8];
  public const int Size = 256;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_compressed8_node {
  public fixed float origin[3];
  public fixed byte exponent[3];
  public byte inner_mask;
  public uint child_base;
  public uint primitive_base;
  public fixed byte meta[8];
  public fixed byte lower_x[8];
  public fixed byte lower_y[8];
  public fixed byte lower_z[8];
  public fixed byte upper_x[8];
  public fixed byte upper_y[8];
  public fixed byte upper_z[8];
  public const int Size = 80;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light {
  public uint type;
  public uint flags;
  public fixed float points[12];
  public fixed float direction[3];
  public float radius;
  public float cos_inner;
  public float cos_outer;
  public float power;
  public uint user_id;
  public ulong link_mask;
  public const int Size = 96;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_mesh_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr vertices;
  public ulong vertex_stride;
  public ulong vertex_count;
  public IntPtr indices;
  public ulong index_stride;
  public ulong triangle_count;
  public IntPtr radiances;
  public ulong radiance_stride;
  public ulong link_mask;
  public float radiance;
  public uint user_id;
  public uint user_id_step;
  public uint reserved;
  public const int Size = 96;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_instance_desc {
  public uint struct_size;
  public float power_scale;
  public IntPtr tree;
  public fixed float local_to_world[12];
  public ulong link_mask;
  public const int Size = 72;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_tree_desc {
  public uint struct_size;
  public uint width;
  public uint builder;
  public float distant_probability;
  public uint flags;
  public uint reserved;
  public const int Size = 24;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_tree_info {
  public uint struct_size;
  public uint width;
  public uint light_count;
  public uint instance_count;
  public uint distant_count;
  public uint node_count;
  public uint depth;
  public uint reserved;
  public ulong bytes;
  public double power;
  public double cost;
  public double build_seconds;
  public const int Size = 64;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_receiver {
  public fixed float position[3];
  public fixed float normal[3];
  public fixed float segment[3];
  public uint flags;
  public ulong link_mask;
  public double random;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_choice {
  public uint light_id;
  public uint instance_id;
  public uint user_id;
  public float probability;
  public double random;
  public const int Size = 24;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_name {
  public uint light_id;
  public uint instance_id;
  public const int Size = 8;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_lobe {
  public fixed float axis[3];
  public float roughness;
  public const int Size = 16;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_pixel {
  public uint x;
  public uint y;
  public uint sample;
  public const int Size = 12;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_light_query {
  public uint struct_size;
  public uint flags;
  public uint method;
  public uint max_choices;
  public float threshold;
  public uint lobe;
  public uint order;
  public float reach;
  public IntPtr lobes;
  public ulong lobe_stride;
  public uint sequence;
  public uint sequence_seed;
  public IntPtr pixels;
  public ulong pixel_stride;
  public const int Size = 72;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_save_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr path;
  public IntPtr write;
  public IntPtr write_user;
  public IntPtr data;
  public ulong capacity;
  public const int Size = 48;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_load_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr path;
  public IntPtr read;
  public IntPtr read_user;
  public IntPtr data;
  public ulong size;
  public uint bvh_width;
  public uint reserved;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_file_info {
  public uint struct_size;
  public uint kind;
  public uint fit;
  public uint format_version;
  public uint library_version;
  public uint bvh_width;
  public uint section_count;
  public uint reserved;
  public ulong file_bytes;
  public ulong triangle_count;
  public ulong node_count;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_moving_mesh_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr vertices;
  public ulong vertex_offset;
  public ulong vertex_stride;
  public ulong vertex_count;
  public ulong step_stride;
  public IntPtr indices;
  public ulong index_offset;
  public ulong index_stride;
  public ulong triangle_count;
  public uint step_count;
  public float time_begin;
  public float time_end;
  public uint mask;
  public const int Size = 96;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_quaternion_transform {
  public float scale_x;
  public float scale_y;
  public float scale_z;
  public float skew_xy;
  public float skew_xz;
  public float skew_yz;
  public float shift_x;
  public float shift_y;
  public float shift_z;
  public float quaternion_r;
  public float quaternion_i;
  public float quaternion_j;
  public float quaternion_k;
  public float translation_x;
  public float translation_y;
  public float translation_z;
  public const int Size = 64;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_moving_instances_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr scenes;
  public ulong scene_count;
  public IntPtr scene_indices;
  public ulong scene_index_stride;
  public IntPtr transforms;
  public ulong transform_stride;
  public ulong step_stride;
  public ulong count;
  public IntPtr masks;
  public ulong mask_stride;
  public uint format;
  public uint step_count;
  public float time_begin;
  public float time_end;
  public uint mask;
  public uint reserved;
  public const int Size = 112;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_opacity_desc {
  public uint struct_size;
  public uint format;
  public uint level;
  public uint reserved;
  public IntPtr maps;
  public ulong map_stride;
  public ulong map_count;
  public IntPtr indices;
  public ulong index_stride;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_spheres_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr points;
  public ulong point_offset;
  public ulong point_stride;
  public ulong sphere_count;
  public uint mask;
  public uint reserved;
  public const int Size = 48;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_discs_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr points;
  public ulong point_offset;
  public ulong point_stride;
  public IntPtr normals;
  public ulong normal_offset;
  public ulong normal_stride;
  public ulong disc_count;
  public uint mask;
  public uint reserved;
  public const int Size = 72;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_curves_desc {
  public uint struct_size;
  public uint flags;
  public IntPtr points;
  public ulong point_offset;
  public ulong point_stride;
  public ulong point_count;
  public IntPtr indices;
  public ulong index_offset;
  public ulong index_stride;
  public ulong segment_count;
  public uint mask;
  public uint reserved;
  public const int Size = 80;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_interpolation {
  public uint struct_size;
  public uint channels;
  public IntPtr attributes;
  public ulong attribute_offset;
  public ulong attribute_stride;
  public ulong attribute_count;
  public IntPtr indices;
  public ulong index_offset;
  public ulong index_stride;
  public kiwami_input_field primitive_id;
  public kiwami_input_field u;
  public kiwami_input_field v;
  public kiwami_input_field geometry_id;
  public uint geometry;
  public uint reserved;
  public IntPtr values;
  public ulong value_stride;
  public IntPtr derivatives_u;
  public ulong derivative_u_stride;
  public IntPtr derivatives_v;
  public ulong derivative_v_stride;
  public const int Size = 184;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_tetrahedra_desc {
  public uint struct_size;
  public uint method;
  public IntPtr vertices;
  public ulong vertex_stride;
  public ulong vertex_count;
  public IntPtr indices;
  public ulong index_stride;
  public ulong tetrahedron_count;
  public const int Size = 56;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_tetrahedra_info {
  public uint struct_size;
  public uint method;
  public ulong tetrahedron_count;
  public ulong skipped_count;
  public ulong inverted_count;
  public ulong face_count;
  public ulong boundary_face_count;
  public ulong crowded_face_count;
  public ulong bytes;
  public double build_seconds;
  public const int Size = 72;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_tetrahedron_location {
  public uint tetrahedron_id;
  public fixed float weights[4];
  public const int Size = 20;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_user_hit {
  public float t;
  public float u;
  public float v;
  public float normal_x;
  public float normal_y;
  public float normal_z;
  public uint primitive_id;
  public uint reserved;
  public const int Size = 32;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_user_intersection {
  public uint struct_size;
  public uint primitive_count;
  public IntPtr primitive_ids;
  public IntPtr ray;
  public uint geometry_id;
  public uint hit_capacity;
  public IntPtr hits;
  public uint hit_count;
  public uint reserved;
  public const int Size = 48;
}

[StructLayout(LayoutKind.Sequential)]
internal unsafe struct kiwami_user_geometry_desc {
  public uint struct_size;
  public uint flags;
  public ulong count;
  public IntPtr bounds;
  public IntPtr intersect;
  public IntPtr destroy;
  public IntPtr user;
  public uint mask;
  public uint reserved;
  public const int Size = 56;
}

internal static class Native {
  const string Library = "kiwami";

  public const uint KIWAMI_ABI_VERSION = 0;
  public const uint KIWAMI_FILE_FORMAT_VERSION = 2;
  public const uint KIWAMI_INVALID_ID = 4294967295;
  public const uint KIWAMI_LIGHT_MAX_CHOICES = 64;
  public const float KIWAMI_MAX_COORDINATE = 1.152921504606847e+18f;
  public const uint KIWAMI_MAX_INSTANCE_DEPTH = 8;
  public const uint KIWAMI_OPACITY_ALL_OPAQUE = 4294967293;
  public const uint KIWAMI_OPACITY_ALL_TRANSPARENT = 4294967292;
  public const uint KIWAMI_OPACITY_ALL_UNKNOWN_OPAQUE = 4294967295;
  public const uint KIWAMI_OPACITY_ALL_UNKNOWN_TRANSPARENT = 4294967294;
  public const uint KIWAMI_VERSION_MAJOR = 0;
  public const uint KIWAMI_VERSION_MINOR = 1;
  public const uint KIWAMI_VERSION_PATCH = 0;
  public const int KIWAMI_OK = 0;
  public const int KIWAMI_ERROR_INVALID_ARGUMENT = -1;
  public const int KIWAMI_ERROR_INVALID_STATE = -2;
  public const int KIWAMI_ERROR_OUT_OF_MEMORY = -3;
  public const int KIWAMI_ERROR_UNSUPPORTED_ISA = -4;
  public const int KIWAMI_ERROR_TOO_LARGE = -5;
  public const int KIWAMI_ERROR_CALLBACK = -6;
  public const int KIWAMI_ERROR_VALIDATION = -7;
  public const int KIWAMI_ERROR_INTERNAL = -8;
  public const int KIWAMI_ERROR_CAPACITY = -9;
  public const int KIWAMI_ERROR_INVALID_FILE = -10;
  public const int KIWAMI_ERROR_IO = -11;
  public const int KIWAMI_ERROR_CANCELLED = -12;
  public const uint KIWAMI_ISA_AUTO = 0;
  public const uint KIWAMI_ISA_SCALAR = 1;
  public const uint KIWAMI_ISA_SSE = 2;
  public const uint KIWAMI_ISA_AVX2 = 3;
  public const uint KIWAMI_ISA_AVX512 = 4;
  public const uint KIWAMI_DEVICE_VALIDATE = 1;
  public const uint KIWAMI_MESH_SHARE_BUFFERS = 1;
  public const uint KIWAMI_PARAMETER_BVH_WIDTH = 1;
  public const uint KIWAMI_PARAMETER_MERGE_LEAVES = 2;
  public const uint KIWAMI_PARAMETER_MERGE_RING = 3;
  public const uint KIWAMI_PARAMETER_BIN_COUNT = 4;
  public const uint KIWAMI_PARAMETER_MAX_LEAF_SIZE = 5;
  public const uint KIWAMI_PARAMETER_NODE_COST = 6;
  public const uint KIWAMI_PARAMETER_LEAF_COST = 7;
  public const uint KIWAMI_PARAMETER_VALIDATE_BUILD = 8;
  public const uint KIWAMI_PARAMETER_CONTRACTION = 9;
  public const uint KIWAMI_PARAMETER_BUILDER = 10;
  public const uint KIWAMI_PARAMETER_SPLIT_BUDGET = 11;
  public const uint KIWAMI_PARAMETER_SPLIT_ALPHA = 12;
  public const uint KIWAMI_PARAMETER_BIN_HALVING = 13;
  public const uint KIWAMI_PARAMETER_REASSIGN = 14;
  public const uint KIWAMI_PARAMETER_AAC_QUALITY = 17;
  public const uint KIWAMI_PARAMETER_CURVE_CODE = 18;
  public const uint KIWAMI_PARAMETER_LBVH_DELTA = 19;
  public const uint KIWAMI_PARAMETER_LBVH_CHUNK_SIZE = 20;
  public const uint KIWAMI_PARAMETER_LAYOUT = 21;
  public const uint KIWAMI_PARAMETER_QUALITY = 30;
  public const uint KIWAMI_PARAMETER_REBRAID = 40;
  public const uint KIWAMI_PARAMETER_REBRAID_BUDGET = 41;
  public const uint KIWAMI_PARAMETER_TWO_LEVEL = 42;
  public const uint KIWAMI_PARAMETER_DIVIDE_TIME = 43;
  public const uint KIWAMI_REBRAID_OFF = 0;
  public const uint KIWAMI_REBRAID_FULL = 1;
  public const uint KIWAMI_REBRAID_ROOTS = 2;
  public const uint KIWAMI_LAYOUT_FAST = 0;
  public const uint KIWAMI_LAYOUT_COMPACT = 1;
  public const uint KIWAMI_STAGE_BUILDER = 1;
  public const uint KIWAMI_STAGE_OPTIMIZER = 2;
  public const uint KIWAMI_STAGE_CONTRACTION = 3;
  public const uint KIWAMI_QUALITY_BALANCED = 0;
  public const uint KIWAMI_QUALITY_FAST = 1;
  public const uint KIWAMI_QUALITY_BEST = 2;
  public const uint KIWAMI_BUILDER_BINNED_SAH = 0;
  public const uint KIWAMI_BUILDER_LBVH = 1;
  public const uint KIWAMI_BUILDER_PLOC = 2;
  public const uint KIWAMI_BUILDER_SWEEP_SAH = 3;
  public const uint KIWAMI_BUILDER_SPATIAL_SPLIT = 4;
  public const uint KIWAMI_BUILDER_AGGLOMERATIVE = 5;
  public const uint KIWAMI_BUILDER_AAC = 6;
  public const uint KIWAMI_BUILDER_MINI_TREE = 7;
  public const uint KIWAMI_BUILDER_OIBVH = 8;
  public const uint KIWAMI_BUILDER_WIDE_BOTTOM_UP = 9;
  public const uint KIWAMI_BUILDER_STR = 10;
  public const uint KIWAMI_BUILDER_TRBVH = 11;
  public const uint KIWAMI_BUILDER_WIDE_TOP_DOWN = 12;
  public const uint KIWAMI_BUILDER_WIDE_LINEAR = 13;
  public const uint KIWAMI_BUILDER_TRIAL = 14;
  public const uint KIWAMI_OPTIMIZER_PARALLEL_REINSERTION = 1;
  public const uint KIWAMI_OPTIMIZER_ROTATION = 2;
  public const uint KIWAMI_OPTIMIZER_TREELET = 3;
  public const uint KIWAMI_OPTIMIZER_AGGLOMERATIVE_TREELET = 4;
  public const uint KIWAMI_OPTIMIZER_REINSERTION = 5;
  public const uint KIWAMI_OPTIMIZER_REORDER_SATO = 6;
  public const uint KIWAMI_OPTIMIZER_REORDER_NARY = 7;
  public const uint KIWAMI_CONTRACTION_SURFACE_AREA = 0;
  public const uint KIWAMI_CONTRACTION_OPTIMAL = 1;
  public const uint KIWAMI_CONTRACTION_RAY_DISTRIBUTION = 2;
  public const uint KIWAMI_MAX_OPTIMIZERS = 8;
  public const uint KIWAMI_INSTANCES_SHARE_BUFFERS = 1;
  public const uint KIWAMI_RAY_CULL_BACK_FACES = 1;
  public const uint KIWAMI_RAY_CULL_FRONT_FACES = 2;
  public const uint KIWAMI_FILTER_REJECT = 0;
  public const uint KIWAMI_FILTER_ACCEPT = 1;
  public const uint KIWAMI_FILTER_ACCEPT_AND_STOP = 2;
  public const uint KIWAMI_QUERY_CALLING_THREAD = 1;
  public const uint KIWAMI_MEASURE_WITHOUT_EPO = 1;
  public const uint KIWAMI_COUNT_CLOSEST_HIT = 0;
  public const uint KIWAMI_COUNT_ANY_HIT = 1;
  public const uint KIWAMI_BINARY_LAYOUT_BOXES = 0;
  public const uint KIWAMI_BINARY_LAYOUT_DUAL_SPLIT = 1;
  public const uint KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST = 0;
  public const uint KIWAMI_DISTRIBUTION_ALIAS_TABLE = 1;
  public const uint KIWAMI_EXPORT_BINARY = 1;
  public const uint KIWAMI_EXPORT_WIDE4 = 2;
  public const uint KIWAMI_EXPORT_WIDE8 = 3;
  public const uint KIWAMI_EXPORT_COMPRESSED8 = 4;
  public const uint KIWAMI_LIGHT_POINT = 0;
  public const uint KIWAMI_LIGHT_SPOT = 1;
  public const uint KIWAMI_LIGHT_TRIANGLE = 2;
  public const uint KIWAMI_LIGHT_QUAD = 3;
  public const uint KIWAMI_LIGHT_SPHERE = 4;
  public const uint KIWAMI_LIGHT_DISC = 5;
  public const uint KIWAMI_LIGHT_DISTANT = 6;
  public const uint KIWAMI_LIGHT_ENVIRONMENT = 7;
  public const uint KIWAMI_LIGHT_TWO_SIDED = 1;
  public const uint KIWAMI_LIGHT_BUILDER_SAOH = 0;
  public const uint KIWAMI_LIGHT_BUILDER_OCTANTS = 1;
  public const uint KIWAMI_LIGHT_TREE_WITH_ROULETTE = 1;
  public const uint KIWAMI_RECEIVER_BOTH_SIDES = 1;
  public const uint KIWAMI_LIGHT_METHOD_TREE = 0;
  public const uint KIWAMI_LIGHT_METHOD_POWER = 1;
  public const uint KIWAMI_LIGHT_METHOD_TREE_SPLITTING = 2;
  public const uint KIWAMI_LIGHT_METHOD_LIGHTCUTS = 3;
  public const uint KIWAMI_LIGHT_METHOD_LAZY_ROULETTE = 4;
  public const uint KIWAMI_LIGHT_METHOD_CULLING = 5;
  public const uint KIWAMI_LIGHT_METHOD_ROULETTE = 6;
  public const uint KIWAMI_LIGHT_LOBE_COSINE = 0;
  public const uint KIWAMI_LIGHT_LOBE_TANGENT_SPHERE = 1;
  public const uint KIWAMI_LIGHT_LOBE_GLOSSY = 2;
  public const uint KIWAMI_LIGHT_ORDER_XOR = 0;
  public const uint KIWAMI_LIGHT_ORDER_SCRAMBLED = 1;
  public const uint KIWAMI_LIGHT_SEQUENCE_RANDOM = 0;
  public const uint KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE = 1;
  public const uint KIWAMI_LIGHT_QUERY_CALLING_THREAD = 1;
  public const uint KIWAMI_LOAD_MAP = 1;
  public const uint KIWAMI_LOAD_TRUSTED = 2;
  public const uint KIWAMI_FILE_SCENE = 1;
  public const uint KIWAMI_FILE_BVH = 2;
  public const uint KIWAMI_FILE_LIGHTS = 3;
  public const uint KIWAMI_FIT_NATIVE = 0;
  public const uint KIWAMI_FIT_SCALAR = 1;
  public const uint KIWAMI_FIT_NONE = 2;
  public const uint KIWAMI_MOVING_MESH_SHARE_BUFFERS = 1;
  public const uint KIWAMI_MAX_TIME_STEPS = 129;
  public const uint KIWAMI_TRANSFORM_MATRIX = 0;
  public const uint KIWAMI_TRANSFORM_QUATERNION = 1;
  public const uint KIWAMI_OPACITY_TRANSPARENT = 0;
  public const uint KIWAMI_OPACITY_OPAQUE = 1;
  public const uint KIWAMI_OPACITY_UNKNOWN_TRANSPARENT = 2;
  public const uint KIWAMI_OPACITY_UNKNOWN_OPAQUE = 3;
  public const uint KIWAMI_OPACITY_2_STATES = 1;
  public const uint KIWAMI_OPACITY_4_STATES = 2;
  public const uint KIWAMI_OPACITY_MAX_LEVEL = 6;
  public const uint KIWAMI_SHAPES_SHARE_BUFFERS = 1;
  public const uint KIWAMI_TETRAHEDRA_BOXES = 0;
  public const uint KIWAMI_TETRAHEDRA_FACES = 1;
  public const uint KIWAMI_USER_HITS_PER_PRIMITIVE = 4;

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern uint kiwami_version();

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern uint kiwami_abi_version();

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern IntPtr kiwami_result_name(int result);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern UIntPtr kiwami_last_error(IntPtr device, IntPtr text, UIntPtr capacity);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_device_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_device_create(IntPtr desc, IntPtr device);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_device_retain(IntPtr device);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_device_release(IntPtr device);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_device_get_info(IntPtr device, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern IntPtr kiwami_isa_name(uint isa);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_triangle_mesh_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_triangle_mesh_create(IntPtr device, IntPtr desc, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_triangle_mesh_update_vertices(IntPtr geometry, IntPtr vertices, ulong vertex_offset, ulong vertex_stride);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_geometry_set_mask(IntPtr geometry, uint mask);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_geometry_retain(IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_geometry_release(IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_create(IntPtr device, IntPtr scene);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_scene_retain(IntPtr scene);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_scene_release(IntPtr scene);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_attach(IntPtr scene, IntPtr geometry, IntPtr geometry_id);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_detach(IntPtr scene, uint geometry_id);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_replace(IntPtr scene, uint geometry_id, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_enable(IntPtr scene, uint geometry_id, int is_enabled);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_set_parameter(IntPtr scene, uint parameter, double value);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_parameter_bounds(uint parameter, IntPtr lowest, IntPtr highest, IntPtr preset);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_set_representative_rays(IntPtr scene, IntPtr rays, UIntPtr stride, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_set_optimizers(IntPtr scene, IntPtr methods, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_quality_methods(uint quality, IntPtr builder, IntPtr optimizers, IntPtr optimizer_count, IntPtr contraction);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern IntPtr kiwami_method_name(uint stage, uint method);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_set_progress(IntPtr scene, IntPtr function, IntPtr user);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_commit(IntPtr scene);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_refit(IntPtr scene);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_get_info(IntPtr scene, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_validate(IntPtr scene);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_instances_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_instances_create(IntPtr device, IntPtr desc, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_ray_fields_init(IntPtr rays, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_hit_fields_init(IntPtr hits, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_query_init(IntPtr query, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_closest_hit(IntPtr scene, IntPtr rays, UIntPtr ray_stride, IntPtr hits, UIntPtr hit_stride, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_any_hit(IntPtr scene, IntPtr rays, UIntPtr ray_stride, IntPtr occluded, UIntPtr stride, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_closest_hit_fields(IntPtr scene, IntPtr rays, IntPtr hits, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_any_hit_fields(IntPtr scene, IntPtr rays, IntPtr occluded, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_multi_hit(IntPtr scene, IntPtr rays, UIntPtr ray_stride, UIntPtr count, uint max_hits, IntPtr hits, ulong hit_capacity, IntPtr offsets, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_count_hits(IntPtr scene, IntPtr rays, UIntPtr ray_stride, IntPtr counts, UIntPtr stride, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_multi_hit_fields(IntPtr scene, IntPtr rays, UIntPtr count, uint max_hits, IntPtr hits, ulong hit_capacity, IntPtr offsets, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_count_hits_fields(IntPtr scene, IntPtr rays, IntPtr counts, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_get_bvh(IntPtr scene, IntPtr bvh);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_build(IntPtr device, IntPtr desc, IntPtr bvh);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_refit(IntPtr bvh, IntPtr boxes, UIntPtr stride, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_validate(IntPtr bvh);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_bvh_retain(IntPtr bvh);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_bvh_release(IntPtr bvh);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_get_info(IntPtr bvh, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_get_nodes(IntPtr bvh, UIntPtr first, UIntPtr count, IntPtr nodes, UIntPtr stride);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_get_primitives(IntPtr bvh, UIntPtr first, UIntPtr count, IntPtr primitives, UIntPtr stride);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_measure_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_measure(IntPtr bvh, IntPtr desc, IntPtr measures, IntPtr nodes, UIntPtr stride);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_count_visits(IntPtr scene, IntPtr rays, UIntPtr ray_stride, UIntPtr count, uint query, IntPtr visits, IntPtr each, UIntPtr each_stride);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_binary_tree_create(IntPtr bvh, uint layout, IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_binary_tree_retain(IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_binary_tree_release(IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_binary_tree_get_info(IntPtr tree, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_binary_tree_validate(IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_binary_tree_closest_hit(IntPtr tree, IntPtr rays, UIntPtr ray_stride, IntPtr hits, UIntPtr hit_stride, UIntPtr count, IntPtr visits);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_distribution_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_distribution_create(IntPtr device, IntPtr desc, IntPtr distribution);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_distribution_retain(IntPtr distribution);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_distribution_release(IntPtr distribution);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_distribution_get_info(IntPtr distribution, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_distribution_sample(IntPtr distribution, IntPtr randoms, UIntPtr random_stride, IntPtr draws, UIntPtr draw_stride, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_distribution_pdf(IntPtr distribution, IntPtr indices, UIntPtr index_stride, IntPtr probabilities, UIntPtr probability_stride, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_export_counts(IntPtr bvh, uint format, IntPtr node_count, IntPtr primitive_count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_export(IntPtr bvh, uint format, IntPtr nodes, UIntPtr node_bytes, IntPtr primitives, UIntPtr primitive_count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_mesh_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_instance_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_query_init(IntPtr query, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_create(IntPtr device, IntPtr desc, IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_light_tree_retain(IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_light_tree_release(IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_add_lights(IntPtr tree, IntPtr lights, UIntPtr stride, UIntPtr count, IntPtr first_id);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_add_mesh(IntPtr tree, IntPtr desc, IntPtr first_id);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_add_instance(IntPtr tree, IntPtr desc, IntPtr instance_id);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_set_lights(IntPtr tree, uint first, IntPtr lights, UIntPtr stride, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_set_powers(IntPtr tree, uint first, IntPtr powers, UIntPtr stride, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_set_instance(IntPtr tree, uint instance_id, IntPtr desc);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_commit(IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_refit(IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_get_info(IntPtr tree, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_sample(IntPtr tree, IntPtr receivers, UIntPtr receiver_stride, IntPtr choices, UIntPtr choice_stride, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_pdf(IntPtr tree, IntPtr receivers, UIntPtr receiver_stride, IntPtr lights, UIntPtr light_stride, IntPtr probabilities, UIntPtr probability_stride, UIntPtr count, IntPtr query);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_save_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_load_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_save(IntPtr scene, IntPtr desc, IntPtr bytes);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_scene_load(IntPtr device, IntPtr desc, IntPtr scene);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_save(IntPtr bvh, IntPtr desc, IntPtr bytes);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_bvh_load(IntPtr device, IntPtr desc, IntPtr bvh);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_save(IntPtr tree, IntPtr desc, IntPtr bytes);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_light_tree_load(IntPtr device, IntPtr desc, IntPtr tree);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_file_get_info(IntPtr device, IntPtr desc, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_moving_mesh_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_moving_mesh_create(IntPtr device, IntPtr desc, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_moving_instances_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_moving_instances_create(IntPtr device, IntPtr desc, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_instances_transform(IntPtr instances, ulong instance, float time, IntPtr transform);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_opacity_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_triangle_mesh_set_opacity(IntPtr mesh, IntPtr desc);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern uint kiwami_opacity_micro_triangle(float u, float v, uint level);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_spheres_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_discs_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_curves_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_spheres_create(IntPtr device, IntPtr desc, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_discs_create(IntPtr device, IntPtr desc, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_curves_create(IntPtr device, IntPtr desc, IntPtr geometry);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_interpolation_init(IntPtr interpolation, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_interpolate(IntPtr mesh, IntPtr interpolation, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_hit_points(IntPtr scene, IntPtr hits, UIntPtr hit_stride, UIntPtr count, IntPtr points, UIntPtr point_stride, IntPtr errors, UIntPtr error_stride);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_offset_origins(IntPtr scene, IntPtr hits, UIntPtr hit_stride, IntPtr directions, UIntPtr direction_stride, UIntPtr count, IntPtr origins, UIntPtr origin_stride);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_tetrahedra_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_tetrahedra_create(IntPtr device, IntPtr desc, IntPtr tetrahedra);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_tetrahedra_retain(IntPtr tetrahedra);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern void kiwami_tetrahedra_release(IntPtr tetrahedra);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_tetrahedra_get_info(IntPtr tetrahedra, IntPtr info);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_tetrahedra_locate(IntPtr tetrahedra, IntPtr points, UIntPtr point_stride, IntPtr locations, UIntPtr location_stride, UIntPtr count);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_user_geometry_desc_init(IntPtr desc, UIntPtr size);

  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
  public static extern int kiwami_user_geometry_create(IntPtr device, IntPtr desc, IntPtr geometry);
}
}
