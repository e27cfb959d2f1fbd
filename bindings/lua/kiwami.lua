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
  return setmetatable(
    { object = ffi.gc(made[0], native.kiwami_scene_release), device = device }, Scene)
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
  return setmetatable(
    { object = ffi.gc(made[0], native.kiwami_scene_release), device = device }, Scene)
end

local function check_scene(scene, result) check(result, scene.device.object) end

local function handle(scene)
  if not scene.object then error("the scene is closed", 3) end
  return scene.object
end

-- Lets go of the scene at once. Closing twice is allowed.
function Scene:close()
  if not self.object then return end
  native.kiwami_scene_release(ffi.gc(self.object, nil))
  self.object = nil
end

-- A table of numbers, or an FFI array with its length in numbers, as an FFI array.
local function numbers(values, length, kind, name)
  local count = length or #values
  if count % 3 ~= 0 then
    error(name .. " has " .. count .. " numbers, expected a multiple of 3", 3)
  end
  if type(values) == "cdata" then return values, count / 3 end
  return ffi.new(kind .. "[?]", math.max(count, 1), values), count / 3
end

-- Adds a mesh, copied: tables of three numbers a vertex and three a triangle (numbers of vertices
-- begin with 0). options: mask; vertex_numbers and triangle_numbers, the lengths of FFI arrays.
-- Returns the number that hits report.
function Scene:add_mesh(vertices, triangles, options)
  options = options or {}
  local positions, vertex_count = numbers(vertices, options.vertex_numbers, "float", "vertices")
  local indices, triangle_count =
    numbers(triangles, options.triangle_numbers, "uint32_t", "triangles")
  local desc = descriptor("kiwami_triangle_mesh_desc", native.kiwami_triangle_mesh_desc_init)
  desc.vertices, desc.vertex_count = positions, vertex_count
  desc.indices, desc.triangle_count = indices, triangle_count
  desc.mask = options.mask or kiwami.ALL_MASKS
  local made = ffi.new("kiwami_geometry*[1]")
  check_scene(self, native.kiwami_triangle_mesh_create(self.device.object, desc, made))
  local number = ffi.new("uint32_t[1]")
  local result = native.kiwami_scene_attach(handle(self), made[0], number)
  native.kiwami_geometry_release(made[0])
  check_scene(self, result)
  return number[0]
end

-- Removes a mesh; its number becomes free.
function Scene:remove(geometry_id)
  check_scene(self, native.kiwami_scene_detach(handle(self), geometry_id))
end

-- Sets one of kiwami.native.KIWAMI_PARAMETER_*.
function Scene:set_parameter(parameter, value)
  check_scene(self, native.kiwami_scene_set_parameter(handle(self), parameter, value))
end

-- Builds the acceleration structure of what the scene holds now.
function Scene:commit() check_scene(self, native.kiwami_scene_commit(handle(self))) end

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

return kiwami
