-- SPDX-License-Identifier: Apache-2.0
-- The answers that every binding must give, to the bit. Run from bindings/lua.
local ffi = require("ffi")
package.path = "./?.lua;" .. package.path
local kiwami = require("kiwami")

local function read(path)
  local file = assert(io.open(path))
  local text = file:read("*a")
  file:close()
  return text
end

local function read_vectors(name) return read("../conformance/" .. name .. ".txt") end

local vectors = read_vectors("vectors")

local function equal(actual, expected, what)
  if actual ~= expected then
    error((what or "value") .. " is " .. tostring(actual) .. ", expected " .. tostring(expected), 2)
  end
end

-- Notes that features were found right, for the table of the documents.
local function note(...)
  local path = os.getenv("KIWAMI_FEATURES")
  if not path then return end
  local file = assert(io.open(path, "a"))
  for _, feature in ipairs({ ... }) do file:write(feature, "\n") end
  file:close()
end

-- Words of the vectors, one after the other.
local function reader(text)
  local next_word = text:gmatch("%S+")
  local self = { word = next_word }
  function self.number() return tonumber(next_word()) end
  function self.words_into(array, count)
    for i = 0, count - 1 do array[i] = self.number() end
    return array
  end
  function self.floats(count)
    local bits = self.words_into(ffi.new("uint32_t[?]", math.max(count, 1)), count)
    local values = ffi.new("float[?]", math.max(count, 1))
    ffi.copy(values, bits, 4 * count)
    return values
  end
  function self.numbers(count)
    local values = {}
    for i = 1, count do values[i] = self.number() end
    return values
  end
  function self.expect_words(array, count, what)
    for i = 0, count - 1 do equal(tonumber(array[i]), self.number(), what) end
  end
  return self
end

local function as_words(array) return ffi.cast("uint32_t*", array) end

local function check_multi_hit(words, scene, rays, count)
  local max_hits, total = words.number(), words.number()
  local hits, offsets = scene:multi_hit(rays, count, max_hits)
  words.expect_words(offsets, count + 1, "offset")
  equal(tonumber(offsets[count]), total, "total")
  words.expect_words(as_words(hits), 9 * total, "multi hit")
  local counts = scene:count_hits(rays, count)
  for i = 0, count - 1 do
    local expected = max_hits == 0 and counts[i] or math.min(counts[i], max_hits)
    equal(tonumber(offsets[i + 1] - offsets[i]), expected, "count")
  end
end

local function check_file(words, device, scene, rays, count)
  local saved = os.tmpname()
  scene:save(saved)
  local expected = as_words(scene:closest_hit(rays, count))
  for _, path in ipairs({ saved, "../conformance/" .. words.word() }) do
    for _, map in ipairs({ false, true }) do
      local loaded = kiwami.load_scene(path, { device = device, map = map, trusted = map })
      local hits = as_words(loaded:closest_hit(rays, count))
      for i = 0, 9 * count - 1 do equal(hits[i], expected[i], path) end
      loaded:close()
    end
  end
  os.remove(saved)
  equal(pcall(kiwami.load_scene, "../conformance/vectors.txt"), false)
  note("files")
end

-- Adds a geometry, by its kind.
local geometries = {}

function geometries.mesh(words, scene)
  local mask, vertex_count, triangle_count = words.number(), words.number(), words.number()
  local vertices = words.floats(3 * vertex_count)
  scene:add_mesh(vertices, words.numbers(3 * triangle_count),
                 { mask = mask, vertex_numbers = 3 * vertex_count })
end

function geometries.moving_mesh(words, scene)
  local mask, steps, times = words.number(), words.number(), words.floats(2)
  local vertex_count, triangle_count = words.number(), words.number()
  local vertices = words.floats(3 * steps * vertex_count)
  scene:add_moving_mesh(vertices, steps, words.numbers(3 * triangle_count),
                        { mask = mask, vertex_numbers = 3 * steps * vertex_count,
                          time_begin = times[0], time_end = times[1] })
end

function geometries.spheres(words, scene)
  local mask, count = words.number(), words.number()
  scene:add_spheres(words.floats(4 * count), { mask = mask, point_numbers = 4 * count })
end

function geometries.discs(words, scene)
  local mask, count = words.number(), words.number()
  local points = words.floats(4 * count)
  scene:add_discs(points, words.floats(3 * count),
                  { mask = mask, point_numbers = 4 * count, normal_numbers = 3 * count })
end

function geometries.curves(words, scene)
  local mask, point_count, segment_count = words.number(), words.number(), words.number()
  local points = words.floats(4 * point_count)
  scene:add_curves(points, words.numbers(segment_count),
                   { mask = mask, point_numbers = 4 * point_count })
end

function geometries.instances(words, scene, scenes)
  local mask, scene_count, count = words.number(), words.number(), words.number()
  local shown, indices, masks = {}, {}, {}
  local transforms = ffi.new("float[?]", 12 * count)
  for i = 1, scene_count do shown[i] = scenes[words.word()] end
  for i = 1, count do
    indices[i], masks[i] = words.number(), words.number()
    ffi.copy(transforms + 12 * (i - 1), words.floats(12), 48)
  end
  scene:add_instances(shown, transforms, { scene_indices = indices, masks = masks, mask = mask,
                                           transform_numbers = 12 * count })
end

-- Changes the scene, or compares answers, by the word of the statement.
local statements = {}

function statements.commit(_, state) state.scene:commit() end
function statements.refit(_, state) state.scene:refit() end
function statements.remove(words, state) state.scene:remove(words.number()) end

function statements.vertices(words, state)
  local geometry_id, count = words.number(), words.number()
  state.scene:update_vertices(geometry_id, words.floats(3 * count), 3 * count)
end

function statements.enable(words, state)
  local geometry_id, is_enabled = words.number(), words.number()
  state.scene:enable(geometry_id, is_enabled ~= 0)
end

function statements.rays(words, state)
  state.count = words.number()
  state.rays = kiwami.rays(state.count)
  words.words_into(as_words(state.rays), 12 * state.count)
  state.compared = state.compared + state.count
end

function statements.closest_hit(words, state)
  local hits = state.scene:closest_hit(state.rays, state.count)
  words.expect_words(as_words(hits), 9 * state.count, "hit")
end

function statements.any_hit(words, state)
  words.expect_words(state.scene:any_hit(state.rays, state.count), state.count, "occluded")
end

function statements.multi_hit(words, state)
  check_multi_hit(words, state.scene, state.rays, state.count)
end

function statements.file(words, state)
  check_file(words, state.device, state.scene, state.rays, state.count)
end

-- Returns how many rays were compared.
local function check_scene(words, device, scenes)
  local state = { device = device, scene = kiwami.scene(device), compared = 0 }
  scenes[words.word()] = state.scene
  local word = words.word()
  while word ~= "end" do
    if geometries[word] then
      geometries[word](words, state.scene, scenes)
    else
      assert(statements[word], word)(words, state)
    end
    word = words.word()
  end
  return state.compared
end

local tests = {}

local function check_vectors(name, ...)
  for _, isa in ipairs({ "auto", "scalar" }) do
    local device = kiwami.device({ isa = isa, validate = true })
    local words, scenes, compared = reader(read_vectors(name)), {}, 0
    equal(words.word(), "kiwami-conformance")
    equal(words.word(), "1")
    while words.word() == "scene" do
      compared = compared + check_scene(words, device, scenes)
    end
    assert(compared > 100)
    for _, scene in pairs(scenes) do scene:close() end
  end
  note(...)
end

function tests.answers_are_the_same_to_the_bit()
  check_vectors("vectors", "closest hit", "any hit", "multi hit", "counts")
  check_vectors("shapes", "spheres, discs, curves")
  check_vectors("moving_meshes", "moving meshes")
  check_vectors("instances", "instances")
  check_vectors("changes", "changes, refit")
end

-- Changes a set of lights, or compares choices, by the word of the statement.
local light_statements = {}

function light_statements.light(words, state)
  local count = words.number()
  local lights = ffi.new("kiwami_light[?]", count)
  words.words_into(as_words(lights), 24 * count)
  state.lights:add_lights(lights, count)
end

function light_statements.light_mesh(words, state)
  local two_sided, radiance = words.number() ~= 0, words.floats(1)[0]
  local vertex_count, triangle_count = words.number(), words.number()
  local vertices = words.floats(3 * vertex_count)
  state.lights:add_mesh(vertices, words.numbers(3 * triangle_count),
                        { two_sided = two_sided, radiance = radiance,
                          vertex_numbers = 3 * vertex_count })
end

function light_statements.powers(words, state)
  local first, count = words.number(), words.number()
  local bits, powers = words.floats(count), {}
  for i = 1, count do powers[i] = bits[i - 1] end
  state.lights:set_powers(first, powers)
end

function light_statements.commit(_, state) state.lights:commit() end
function light_statements.refit(_, state) state.lights:refit() end

function light_statements.receivers(words, state)
  state.count = words.number()
  state.receivers = kiwami.light_receivers(state.count)
  words.words_into(as_words(state.receivers), 14 * state.count)
end

function light_statements.choices(words, state)
  state.choices = state.lights:sample(state.receivers, state.count)
  words.expect_words(as_words(state.choices), 6 * state.count, "choice")
  state.compared = state.compared + state.count
end

function light_statements.pdf(words, state)
  local probabilities = state.lights:pdf(state.receivers, state.count, state.choices)
  words.expect_words(as_words(probabilities), state.count, "probability")
end

function tests.choices_are_the_same_to_the_bit()
  for _, isa in ipairs({ "auto", "scalar" }) do
    local device = kiwami.device({ isa = isa, validate = true })
    local words, compared = reader(read_vectors("lights")), 0
    equal(words.word(), "kiwami-conformance")
    equal(words.word(), "1")
    while words.word() == "lights" do
      local lights = kiwami.light_tree({ device = device, width = words.number() })
      local state = { lights = lights, compared = 0 }
      local word = words.word()
      while word ~= "end" do
        assert(light_statements[word], word)(words, state)
        word = words.word()
      end
      compared = compared + state.compared
      lights:close()
      lights:close()
    end
    assert(compared > 100)
  end
  note("many lights")
end

function tests.bad_lights_are_errors()
  local lights, one = kiwami.light_tree(), kiwami.light_receivers(1)
  equal(pcall(lights.sample, lights, one, 1), false)
  equal(pcall(lights.add_mesh, lights, { 0, 0, 0 }, { 0, 0, 1 }), false)
  equal(pcall(lights.set_powers, lights, 0, { 1 }), false)
  equal(pcall(kiwami.light_tree, { width = 3 }), false)
  lights:commit()
  equal(lights:sample(one, 1)[0].light_id, kiwami.INVALID_ID)
  lights:close()
  equal(pcall(lights.commit, lights), false)
end

function tests.geometries_of_wrong_sizes_are_errors()
  local scene, other = kiwami.scene(), kiwami.scene()
  local zeros = { 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }
  equal(pcall(scene.add_discs, scene, { 0, 0, 0, 1 }, {}), false)
  equal(pcall(scene.add_moving_mesh, scene, { 0, 0, 0 }, 2, {}), false)
  equal(pcall(scene.add_moving_mesh, scene, { 0, 0, 0 }, 0, {}), false)
  equal(pcall(scene.add_instances, scene, { other }, zeros, { scene_indices = { 0, 0 } }), false)
  equal(pcall(scene.add_instances, scene, {}, zeros), false)
  equal(pcall(scene.update_vertices, scene, 0, { 0, 0, 0 }), false)
  equal(scene:add_spheres({ 0, 0, 0, 1 }), 0)
  equal(pcall(scene.update_vertices, scene, 0, { 0, 0, 0 }), false)
  scene:commit()
  scene:close()
end

function tests.errors_are_the_same()
  local scene = kiwami.scene()
  local calls = {
    index_beyond_vertices = function() scene:add_mesh({ 0, 0, 0, 1, 0, 0, 0, 1, 0 }, { 0, 1, 3 }) end,
    unknown_geometry = function() scene:remove(5) end,
    parameter_out_of_bounds = function()
      scene:set_parameter(kiwami.native.KIWAMI_PARAMETER_BIN_COUNT, 1000)
    end,
    not_committed = function() scene:closest_hit(kiwami.rays(1), 1) end,
  }
  local count = 0
  for name, result, sentence in vectors:gmatch("error (%S+) (%S+) ([^\n]+)") do
    local is_ok, problem = pcall(calls[name])
    equal(is_ok, false, name)
    equal(getmetatable(problem), kiwami.Error, name)
    equal(problem.result, tonumber(result), name)
    equal(tostring(problem), sentence, name)
    count = count + 1
  end
  equal(count, 4, "number of errors")
  note("errors")
end

function tests.misuse_is_an_error()
  local scene = kiwami.scene()
  equal(pcall(kiwami.device, { isa = "mmx" }), false)
  equal(pcall(scene.add_mesh, scene, { 0, 0 }, {}), false)
  scene:commit()
  scene:close()
  scene:close()
  equal(pcall(scene.commit, scene), false)
end

local failed = 0
for name, run in pairs(tests) do
  local is_ok, problem = xpcall(run, function(e) return debug.traceback(tostring(e)) end)
  print((is_ok and "ok " or "FAILED ") .. name .. (is_ok and "" or ": " .. problem))
  if not is_ok then failed = failed + 1 end
end
os.exit(failed == 0 and 0 or 1)
