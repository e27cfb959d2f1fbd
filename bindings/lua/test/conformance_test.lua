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

local vectors = read("../conformance/vectors.txt")

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

local function read_mesh(words, scene)
  local mask, vertex_count, triangle_count = words.number(), words.number(), words.number()
  local bits = words.words_into(ffi.new("uint32_t[?]", 3 * vertex_count), 3 * vertex_count)
  local triangles = words.words_into(ffi.new("uint32_t[?]", math.max(3 * triangle_count, 1)),
                                     3 * triangle_count)
  scene:add_mesh(ffi.cast("float*", bits), triangles,
                 { mask = mask, vertex_numbers = 3 * vertex_count,
                   triangle_numbers = 3 * triangle_count })
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

local function check_scene(words, device)
  local scene = kiwami.scene(device)
  words.word()
  local word = words.word()
  while word == "mesh" do
    read_mesh(words, scene)
    word = words.word()
  end
  equal(word, "rays")
  local count = words.number()
  local rays = kiwami.rays(count)
  words.words_into(as_words(rays), 12 * count)
  scene:commit()
  equal(words.word(), "closest_hit")
  words.expect_words(as_words(scene:closest_hit(rays, count)), 9 * count, "hit")
  equal(words.word(), "any_hit")
  words.expect_words(scene:any_hit(rays, count), count, "occluded")
  word = words.word()
  while word == "multi_hit" do
    check_multi_hit(words, scene, rays, count)
    word = words.word()
  end
  if word == "file" then
    check_file(words, device, scene, rays, count)
    word = words.word()
  end
  equal(word, "end")
  note("closest hit", "any hit", "multi hit", "counts")
  scene:close()
  return count
end

local tests = {}

function tests.answers_are_the_same_to_the_bit()
  for _, isa in ipairs({ "auto", "scalar" }) do
    local device = kiwami.device({ isa = isa, validate = true })
    local words = reader(vectors)
    equal(words.word(), "kiwami-conformance")
    equal(words.word(), "1")
    local compared = 0
    while words.word() == "scene" do compared = compared + check_scene(words, device) end
    assert(compared > 100)
  end
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
