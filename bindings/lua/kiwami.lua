-- SPDX-License-Identifier: Apache-2.0
-- Kiwami for LuaJIT: ray tracing on CPUs, in batches of FFI arrays.
--
-- The C interface comes from the headers themselves, by the C compiler's preprocessor
-- (cc -E -P kiwami.h > kiwami_ffi.h): the file that KIWAMI_FFI_HEADER names, or kiwami_ffi.h beside
-- this one. The library is the one that KIWAMI_LIBRARY names, or the system's.

local ffi = require("ffi")

local folder = debug.getinfo(1, "S").source:match("^@(.*[/\\])") or "./"

local function read_header()
  local path = os.getenv("KIWAMI_FFI_HEADER") or folder .. "kiwami_ffi.h"
  local file = assert(io.open(path))
  local text = file:read("*a")
  file:close()
  -- Attributes of visibility mean nothing to the FFI.
  return (text:gsub("__attribute__%s*%(%b()%)", ""))
end

ffi.cdef(read_header())
local native = ffi.load(os.getenv("KIWAMI_LIBRARY") or "kiwami")

local kiwami = { native = native, INVALID_ID = 0xFFFFFFFF, ALL_MASKS = 0xFFFFFFFF }

-- Errors are tables with the library's number and sentence; tostring gives the sentence.
local Error = { __tostring = function(self) return self.sentence end }
kiwami.Error = Error

local function check(result, device)
  if result == native.KIWAMI_OK then return end
  local text = ffi.new("char[1024]")
  native.kiwami_last_error(device, text, 1024)
  local sentence = ffi.string(text)
  if sentence == "" then sentence = ffi.string(native.kiwami_result_name(result)) end
  error(setmetatable({ result = result, sentence = sentence }, Error), 0)
end

local function descriptor(kind, init)
  local made = ffi.new(kind)
  check(init(made, ffi.sizeof(made)))
  return made
end

-- Devices -------------------------------------------------------------------------------------

local isas = {
  auto = native.KIWAMI_ISA_AUTO,
  scalar = native.KIWAMI_ISA_SCALAR,
  sse = native.KIWAMI_ISA_SSE,
  avx2 = native.KIWAMI_ISA_AVX2,
  avx512 = native.KIWAMI_ISA_AVX512,
}

local Device = {}
Device.__index = Device

-- options: isa ("auto", "scalar", "sse", "avx2", "avx512"), threads (0: one per processor),
-- validate (check the arguments of the trace calls in the library too).
function kiwami.device(options)
  options = options or {}
  local isa = isas[options.isa or "auto"]
  if not isa then error("isa is '" .. tostring(options.isa) .. "', expected one of its names", 2) end
  local desc = descriptor("kiwami_device_desc", native.kiwami_device_desc_init)
  desc.isa = isa
  desc.thread_count = options.threads or 0
  desc.flags = options.validate and native.KIWAMI_DEVICE_VALIDATE or 0
  local made = ffi.new("kiwami_device*[1]")
  check(native.kiwami_device_create(desc, made))
  return setmetatable({ object = ffi.gc(made[0], native.kiwami_device_release) }, Device)
end

-- The name of the instruction set whose kernels run.
function Device:isa()
  local info = ffi.new("kiwami_device_info")
  info.struct_size = ffi.sizeof(info)
  check(native.kiwami_device_get_info(self.object, info), self.object)
  return ffi.string(native.kiwami_isa_name(info.isa))
end

-- Rays and hits -------------------------------------------------------------------------------

-- A zero-based array of kiwami_ray, without end and met by meshes of all masks.
function kiwami.rays(count)
  local rays = ffi.new("kiwami_ray[?]", count)
  for i = 0, count - 1 do
    rays[i].tmax = math.huge
    rays[i].mask = kiwami.ALL_MASKS
  end
  return rays
end

function kiwami.is_hit(hit) return hit.primitive_id ~= kiwami.INVALID_ID end

-- Scenes --------------------------------------------------------------------------------------

local Scene = {}
Scene.__index = Scene

-- An empty scene; without a device it makes one of its own.
function kiwami.scene(device)
  device = device or kiwami.device()
  local made = ffi.new("kiwami_scene*[1]")
  check(native.kiwami_scene_create(device.object, made), device.object)
  local object = ffi.gc(made[0], native.kiwami_scene_release)
  return setmetatable({ object = object, device = device, attached = {} }, Scene)
end

-- Loads a scene that save wrote. options: device; map (use the file where it lies, which may not
-- change); trusted (check nothing, for files that nobody else could change).
function kiwami.load_scene(path, options)
  options = options or {}
  local device = options.device or kiwami.device()
  local desc = descriptor("kiwami_load_desc", native.kiwami_load_desc_init)
  desc.path = path
  desc.flags = (options.map and native.KIWAMI_LOAD_MAP or 0)
    + (options.trusted and native.KIWAMI_LOAD_TRUSTED or 0)
  local made = ffi.new("kiwami_scene*[1]")
  check(native.kiwami_scene_load(device.object, desc, made), device.object)
  local object = ffi.gc(made[0], native.kiwami_scene_release)
  return setmetatable({ object = object, device = device, attached = {} }, Scene)
end

local function check_scene(scene, result) check(result, scene.device.object) end

local function handle(scene)
  if not scene.object then error("the scene is closed", 3) end
  return scene.object
end

-- Lets go of the scene at once. Closing twice is allowed.
function Scene:close()
  if not self.object then return end
  for _, each in pairs(self.attached) do
    native.kiwami_geometry_release(ffi.gc(each.geometry, nil))
  end
  native.kiwami_scene_release(ffi.gc(self.object, nil))
  self.object, self.attached = nil, {}
end

-- A table of numbers, or an FFI array with its length in numbers, as an FFI array; and how many rows
-- of so many numbers there are.
local function rows(values, length, columns, kind, name)
  local count = length or #values
  if count % columns ~= 0 then
    error(name .. " has " .. count .. " numbers, expected a multiple of " .. columns, 4)
  end
  if type(values) == "cdata" then return values, count / columns end
  return ffi.new(kind .. "[?]", math.max(count, 1), values), count / columns
end

local function require_rows(found, expected, name)
  if found ~= expected then
    error(name .. " has " .. found .. " rows, expected " .. expected, 3)
  end
end

-- Makes a geometry of a descriptor, attaches it, and returns the number that hits report. buffers are
-- what the descriptor points to: it does not keep them.
local function add(scene, kind, desc, buffers, vertex_count)
  scene.buffers = buffers
  local made = ffi.new("kiwami_geometry*[1]")
  local result = native["kiwami_" .. kind .. "_create"](scene.device.object, desc, made)
  scene.buffers = nil
  check_scene(scene, result)
  local geometry = ffi.gc(made[0], native.kiwami_geometry_release)
  local number = ffi.new("uint32_t[1]")
  check_scene(scene, native.kiwami_scene_attach(handle(scene), geometry, number))
  scene.attached[number[0]] = { geometry = geometry, vertex_count = vertex_count }
  return number[0]
end

local function describe(kind)
  return descriptor("kiwami_" .. kind .. "_desc", native["kiwami_" .. kind .. "_desc_init"])
end

-- Adds a mesh, copied: tables of three numbers a vertex and three a triangle (numbers of vertices
-- begin with 0). options: mask; vertex_numbers and triangle_numbers, the lengths of FFI arrays.
-- Returns the number that hits report, as all of these do.
function Scene:add_mesh(vertices, triangles, options)
  options = options or {}
  local positions, vertex_count =
    rows(vertices, options.vertex_numbers, 3, "float", "vertices")
  local indices, triangle_count =
    rows(triangles, options.triangle_numbers, 3, "uint32_t", "triangles")
  local desc = describe("triangle_mesh")
  desc.vertices, desc.vertex_count = positions, vertex_count
  desc.indices, desc.triangle_count = indices, triangle_count
  desc.mask = options.mask or kiwami.ALL_MASKS
  return add(self, "triangle_mesh", desc, { positions, indices }, vertex_count)
end

-- Adds a mesh whose vertices move from step to step: those of all steps, one step after the other.
-- options as of add_mesh, and time_begin (0) and time_end (1).
function Scene:add_moving_mesh(vertices, step_count, triangles, options)
  options = options or {}
  local columns = 3 * math.max(step_count, 1)
  local positions, vertex_count =
    rows(vertices, options.vertex_numbers, columns, "float", "vertices of all steps")
  local indices, triangle_count =
    rows(triangles, options.triangle_numbers, 3, "uint32_t", "triangles")
  local desc = describe("moving_mesh")
  desc.vertices, desc.vertex_count, desc.step_count = positions, vertex_count, step_count
  desc.indices, desc.triangle_count = indices, triangle_count
  desc.time_begin, desc.time_end = options.time_begin or 0, options.time_end or 1
  desc.mask = options.mask or kiwami.ALL_MASKS
  return add(self, "moving_mesh", desc, { positions, indices })
end

-- Adds spheres: x, y, z and radius. options: mask; point_numbers, the length of an FFI array.
function Scene:add_spheres(points, options)
  options = options or {}
  local desc = describe("spheres")
  local copied, count = rows(points, options.point_numbers, 4, "float", "points")
  desc.points, desc.sphere_count = copied, count
  desc.mask = options.mask or kiwami.ALL_MASKS
  return add(self, "spheres", desc, { copied })
end

-- Adds flat discs, as many points as normals. options as of add_spheres, and normal_numbers.
function Scene:add_discs(points, normals, options)
  options = options or {}
  local desc = describe("discs")
  local copied, count = rows(points, options.point_numbers, 4, "float", "points")
  local directions, normal_count = rows(normals, options.normal_numbers, 3, "float", "normals")
  require_rows(normal_count, count, "normals")
  desc.points, desc.normals, desc.disc_count = copied, directions, count
  desc.mask = options.mask or kiwami.ALL_MASKS
  return add(self, "discs", desc, { copied, directions })
end

-- Adds round curve segments: each joins the points of this number (from 0 on) and the next.
-- options as of add_spheres, and segment_numbers.
function Scene:add_curves(points, segments, options)
  options = options or {}
  local desc = describe("curves")
  local copied, count = rows(points, options.point_numbers, 4, "float", "points")
  local indices, segment_count =
    rows(segments, options.segment_numbers, 1, "uint32_t", "segments")
  desc.points, desc.point_count = copied, count
  desc.indices, desc.segment_count = indices, segment_count
  desc.mask = options.mask or kiwami.ALL_MASKS
  return add(self, "curves", desc, { copied, indices })
end

-- Adds instances of a list of scenes. transforms: three rows of four numbers each, from the scene's
-- space to this one's. options: the tables scene_indices, which of the scenes (from 0 on) each shows,
-- and masks, which rays enter each; mask; transform_numbers, the length of an FFI array. A commit shows what the
-- scenes have committed by then.
function Scene:add_instances(scenes, transforms, options)
  options = options or {}
  local desc = describe("instances")
  local shown = ffi.new("kiwami_scene*[?]", math.max(#scenes, 1))
  for i, scene in ipairs(scenes) do shown[i - 1] = handle(scene) end
  local matrices, count =
    rows(transforms, options.transform_numbers, 12, "float", "transforms")
  local indices, masks = nil, nil
  if options.scene_indices then
    require_rows(#options.scene_indices, count, "scene_indices")
    indices = rows(options.scene_indices, nil, 1, "uint32_t", "scene_indices")
  end
  if options.masks then
    require_rows(#options.masks, count, "masks")
    masks = rows(options.masks, nil, 1, "uint32_t", "masks")
  end
  desc.scenes, desc.scene_count = shown, #scenes
  desc.transforms, desc.count = matrices, count
  desc.scene_indices, desc.masks = indices, masks
  desc.mask = options.mask or kiwami.ALL_MASKS
  return add(self, "instances", desc, { shown, matrices, indices, masks })
end

-- Gives a mesh other vertices, as many as it has; refit or commit shows them.
function Scene:update_vertices(geometry_id, vertices, vertex_numbers)
  local mesh = self.attached[geometry_id]
  if not mesh or not mesh.vertex_count then
    error("geometry " .. tostring(geometry_id) .. " is no mesh", 2)
  end
  local positions, count = rows(vertices, vertex_numbers, 3, "float", "vertices")
  require_rows(count, mesh.vertex_count, "vertices")
  check_scene(
    self, native.kiwami_triangle_mesh_update_vertices(mesh.geometry, positions, 0, 0))
end

-- Leaves a geometry out (false), or takes it in again, under its number.
function Scene:enable(geometry_id, is_enabled)
  local number = is_enabled == false and 0 or 1
  check_scene(self, native.kiwami_scene_enable(handle(self), geometry_id, number))
end

-- Removes a geometry; its number becomes free.
function Scene:remove(geometry_id)
  check_scene(self, native.kiwami_scene_detach(handle(self), geometry_id))
  self.attached[geometry_id] = nil
end

-- Sets one of kiwami.native.KIWAMI_PARAMETER_*.
function Scene:set_parameter(parameter, value)
  check_scene(self, native.kiwami_scene_set_parameter(handle(self), parameter, value))
end

-- Builds the acceleration structure of what the scene holds now.
function Scene:commit() check_scene(self, native.kiwami_scene_commit(handle(self))) end

-- As commit, but keeps the tree where only vertices moved: quicker to make, and, the further they
-- moved, slower to trace.
function Scene:refit() check_scene(self, native.kiwami_scene_refit(handle(self))) end

-- Saves the committed scene; a file of that name stays whole until all is written.
function Scene:save(path)
  local desc = descriptor("kiwami_save_desc", native.kiwami_save_desc_init)
  desc.path = path
  check_scene(self, native.kiwami_scene_save(handle(self), desc, nil))
end

-- The closest hit of each of count rays, in a zero-based array of kiwami_hit.
function Scene:closest_hit(rays, count, hits)
  hits = hits or ffi.new("kiwami_hit[?]", count)
  check_scene(self, native.kiwami_closest_hit(handle(self), rays, 0, hits, 0, count, nil))
  return hits
end

-- 1 for each ray that has a hit, 0 for the others, in a zero-based array of bytes.
function Scene:any_hit(rays, count, occluded)
  occluded = occluded or ffi.new("uint8_t[?]", count)
  check_scene(self, native.kiwami_any_hit(handle(self), rays, 0, occluded, 0, count, nil))
  return occluded
end

-- The nearest max_hits hits of each ray (0: all), by rising distance: those of ray i are
-- hits[offsets[i]] to hits[offsets[i + 1] - 1]. Returns hits and offsets.
function Scene:multi_hit(rays, count, max_hits)
  local offsets = ffi.new("uint64_t[?]", count + 1)
  local capacity = math.max(count, 1)
  while true do
    local hits = ffi.new("kiwami_hit[?]", capacity)
    local result = native.kiwami_multi_hit(
      handle(self), rays, 0, count, max_hits or 0, hits, capacity, offsets, nil)
    if result ~= native.KIWAMI_ERROR_CAPACITY then
      check_scene(self, result)
      return hits, offsets
    end
    capacity = tonumber(offsets[count])
  end
end

-- How many hits each ray has, in a zero-based array of uint32_t.
function Scene:count_hits(rays, count, counts)
  counts = counts or ffi.new("uint32_t[?]", count)
  check_scene(self, native.kiwami_count_hits(handle(self), rays, 0, counts, 0, count, nil))
  return counts
end

-- Many lights ---------------------------------------------------------------------------------

local LightTree = {}
LightTree.__index = LightTree

-- Lights, among which points choose in proportion to what may reach them. options: device; width, of
-- the tree's nodes: 2, 4, 8 or 16. Changes take effect with commit or refit.
function kiwami.light_tree(options)
  options = options or {}
  local device = options.device or kiwami.device()
  local desc = descriptor("kiwami_light_tree_desc", native.kiwami_light_tree_desc_init)
  desc.width = options.width or 0
  local made = ffi.new("kiwami_light_tree*[1]")
  check(native.kiwami_light_tree_create(device.object, desc, made), device.object)
  local object = ffi.gc(made[0], native.kiwami_light_tree_release)
  return setmetatable({ object = object, device = device }, LightTree)
end

local function tree_of(lights)
  if not lights.object then error("the set of lights is closed", 3) end
  return lights.object
end

-- Lets go of the set at once. Closing twice is allowed.
function LightTree:close()
  if not self.object then return end
  native.kiwami_light_tree_release(ffi.gc(self.object, nil))
  self.object = nil
end

-- Adds count lights of a zero-based array of kiwami_light; returns the number of the first.
function LightTree:add_lights(lights, count)
  local first = ffi.new("uint32_t[1]")
  check_scene(self, native.kiwami_light_tree_add_lights(tree_of(self), lights, 0, count, first))
  return first[0]
end

-- Makes a light of each triangle; returns the number of the first. vertices, triangles and options as
-- of Scene:add_mesh; options also: radiance (1), two_sided.
function LightTree:add_mesh(vertices, triangles, options)
  options = options or {}
  local positions, vertex_count = rows(vertices, options.vertex_numbers, 3, "float", "vertices")
  local indices, triangle_count =
    rows(triangles, options.triangle_numbers, 3, "uint32_t", "triangles")
  local desc = descriptor("kiwami_light_mesh_desc", native.kiwami_light_mesh_desc_init)
  desc.flags = options.two_sided and native.KIWAMI_LIGHT_TWO_SIDED or 0
  desc.vertices, desc.vertex_count = positions, vertex_count
  desc.indices, desc.triangle_count = indices, triangle_count
  desc.radiance = options.radiance or 1
  self.buffers = { positions, indices }
  local first = ffi.new("uint32_t[1]")
  local result = native.kiwami_light_tree_add_mesh(tree_of(self), desc, first)
  self.buffers = nil
  check_scene(self, result)
  return first[0]
end

-- Gives the lights from first on other powers: a table.
function LightTree:set_powers(first, powers)
  local values = ffi.new("float[?]", math.max(#powers, 1), powers)
  check_scene(
    self, native.kiwami_light_tree_set_powers(tree_of(self), first, values, 0, #powers))
end

-- Builds the tree over all lights.
function LightTree:commit() check_scene(self, native.kiwami_light_tree_commit(tree_of(self))) end

-- As commit, but keeps the shape of the tree.
function LightTree:refit() check_scene(self, native.kiwami_light_tree_refit(tree_of(self))) end

-- A zero-based array of kiwami_light_receiver, which every light may reach.
function kiwami.light_receivers(count)
  local receivers = ffi.new("kiwami_light_receiver[?]", count)
  for i = 0, count - 1 do receivers[i].link_mask = -1ULL end
  return receivers
end

-- Lets each of count receivers choose a light: a zero-based array of kiwami_light_choice.
function LightTree:sample(receivers, count, choices)
  choices = choices or ffi.new("kiwami_light_choice[?]", count)
  check_scene(
    self, native.kiwami_light_sample(tree_of(self), receivers, 0, choices, 0, count, nil))
  return choices
end

-- The probability with which each receiver chooses the light of the choice beside it: a zero-based
-- array of floats.
function LightTree:pdf(receivers, count, choices)
  local probabilities = ffi.new("float[?]", count)
  -- A choice begins with the name of its light.
  local names = ffi.cast("const kiwami_light_name*", choices)
  check_scene(
    self,
    native.kiwami_light_pdf(
      tree_of(self), receivers, 0, names, ffi.sizeof("kiwami_light_choice"), probabilities, 0,
      count, nil))
  return probabilities
end

return kiwami
