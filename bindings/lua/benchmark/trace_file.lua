-- SPDX-License-Identifier: Apache-2.0
-- See bindings/benchmark/trace_file.c.
local ffi = require("ffi")
local kiwami = require("kiwami")

ffi.cdef([[
typedef struct { int64_t seconds, nanoseconds; } trace_file_time;
int clock_gettime(int clock, trace_file_time* time);
]])

local function now()
  local time = ffi.new("trace_file_time")
  ffi.C.clock_gettime(1, time)
  return tonumber(time.seconds) + 1e-9 * tonumber(time.nanoseconds)
end

local file = assert(io.open(arg[2], "rb"))
local bytes = file:read("*a")
file:close()
local count = #bytes / 48
local rays = kiwami.rays(count)
ffi.copy(rays, bytes, #bytes)
local scene = kiwami.load_scene(arg[1], { map = true, trusted = true })
local hits = ffi.new("kiwami_hit[?]", count)
for _ = 1, tonumber(arg[3]) do
  local began = now()
  scene:closest_hit(rays, count, hits)
  print(now() - began)
end
