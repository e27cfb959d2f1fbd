// SPDX-License-Identifier: Apache-2.0

package kiwami

/*
#include <kiwami/kiwami.h>
#include <stdlib.h>
*/
import "C"

import (
	"math"
	"runtime"
	"unsafe"
)

// NewRay makes a ray without end that meets meshes of all masks.
func NewRay(origin, direction [3]float32) Ray {
	return Ray{Origin: origin, Direction: direction, TMax: float32(math.Inf(1)), Mask: AllMasks}
}

// Scene is meshes under one acceleration structure. Changes take effect with Commit.
type Scene struct {
	object   *C.kiwami_scene
	device   *C.kiwami_device
	attached map[uint32]attached
}

// NewScene makes an empty scene; without a device (nil) it makes one of its own.
func NewScene(device *Device) (*Scene, error) {
	if device == nil {
		own, err := NewDevice(nil)
		if err != nil {
			return nil, err
		}
		defer own.Close() // the scene holds it
		device = own
	}
	scene := &Scene{attached: map[uint32]attached{}}
	err := onOneThread(func() error {
		return check(C.kiwami_scene_create(device.object, &scene.object), device.object)
	})
	if err != nil {
		return nil, err
	}
	scene.device = device.object
	C.kiwami_device_retain(scene.device)
	runtime.SetFinalizer(scene, (*Scene).Close)
	return scene, nil
}

// Close lets go of the scene. Closing twice is allowed.
func (s *Scene) Close() {
	for _, each := range s.attached {
		C.kiwami_geometry_release(each.geometry)
	}
	s.attached = nil
	C.kiwami_scene_release(s.object)
	C.kiwami_device_release(s.device)
	s.object, s.device = nil, nil
	runtime.SetFinalizer(s, nil)
}

// call runs a call of the C interface on this scene.
func (s *Scene) call(body func() C.kiwami_result) error {
	if s.object == nil {
		return &Error{C.KIWAMI_ERROR_INVALID_STATE, "the scene is closed", nil}
	}
	defer runtime.KeepAlive(s)
	return onOneThread(func() error { return check(body(), s.device) })
}

func address[T any](slice []T) unsafe.Pointer {
	if len(slice) == 0 {
		return nil
	}
	return unsafe.Pointer(&slice[0])
}

// SetParameter sets one of KIWAMI_PARAMETER_* of scene.h.
func (s *Scene) SetParameter(parameter uint32, value float64) error {
	return s.call(func() C.kiwami_result {
		return C.kiwami_scene_set_parameter(s.object, C.uint32_t(parameter), C.double(value))
	})
}

// Commit builds the acceleration structure of what the scene holds now.
func (s *Scene) Commit() error {
	return s.callWithCallbacks(&firstError{}, func() C.kiwami_result { return C.kiwami_scene_commit(s.object) })
}

// Refit is Commit, but keeps the tree where only vertices moved: quicker to make, and, the further
// they moved, slower to trace.
func (s *Scene) Refit() error {
	return s.callWithCallbacks(&firstError{}, func() C.kiwami_result { return C.kiwami_scene_refit(s.object) })
}

// ClosestHit finds the closest hit of each ray.
func (s *Scene) ClosestHit(rays []Ray, options ...Option) ([]Hit, error) {
	hits := make([]Hit, len(rays))
	return hits, s.ClosestHitInto(rays, hits, options...)
}

// ClosestHitInto is the same, into hits, of which there must be as many as rays.
func (s *Scene) ClosestHitInto(rays []Ray, hits []Hit, options ...Option) error {
	if len(hits) != len(rays) {
		return invalid("there is room for %d hits, expected %d", len(hits), len(rays))
	}
	return s.trace(options, func(query *C.kiwami_query) C.kiwami_result {
		return C.kiwami_closest_hit(s.object, (*C.kiwami_ray)(address(rays)), 0,
			(*C.kiwami_hit)(address(hits)), 0, C.size_t(len(rays)), query)
	})
}

// AnyHit finds out of each ray whether it has a hit.
func (s *Scene) AnyHit(rays []Ray, options ...Option) ([]bool, error) {
	occluded := make([]bool, len(rays))
	err := s.trace(options, func(query *C.kiwami_query) C.kiwami_result {
		return C.kiwami_any_hit(s.object, (*C.kiwami_ray)(address(rays)), 0,
			(*C.uint8_t)(address(occluded)), 0, C.size_t(len(rays)), query)
	})
	return occluded, err
}

// MultiHits are the hits of many rays: those of ray i are Hits[Offsets[i]:Offsets[i+1]].
type MultiHits struct {
	Offsets []uint64
	Hits    []Hit
}

// Of returns the hits of one ray, by rising distance.
func (m MultiHits) Of(ray int) []Hit { return m.Hits[m.Offsets[ray]:m.Offsets[ray+1]] }

// MultiHit finds the nearest maxHits hits of each ray; 0 stands for all.
func (s *Scene) MultiHit(rays []Ray, maxHits uint32, options ...Option) (MultiHits, error) {
	found := MultiHits{make([]uint64, len(rays)+1), make([]Hit, len(rays))}
	for {
		isComplete := true
		err := s.trace(options, func(query *C.kiwami_query) C.kiwami_result {
			result := C.kiwami_multi_hit(s.object, (*C.kiwami_ray)(address(rays)), 0,
				C.size_t(len(rays)), C.uint32_t(maxHits), (*C.kiwami_hit)(address(found.Hits)),
				C.uint64_t(len(found.Hits)), (*C.uint64_t)(address(found.Offsets)), query)
			if result == C.KIWAMI_ERROR_CAPACITY {
				isComplete = false
				return C.KIWAMI_OK
			}
			return result
		})
		if err != nil {
			return MultiHits{}, err
		}
		needed := found.Offsets[len(rays)]
		if isComplete {
			found.Hits = found.Hits[:needed]
			return found, nil
		}
		found.Hits = make([]Hit, needed)
	}
}

// CountHits counts the hits of each ray.
func (s *Scene) CountHits(rays []Ray, options ...Option) ([]uint32, error) {
	counts := make([]uint32, len(rays))
	err := s.trace(options, func(query *C.kiwami_query) C.kiwami_result {
		return C.kiwami_count_hits(s.object, (*C.kiwami_ray)(address(rays)), 0,
			(*C.uint32_t)(address(counts)), 0, C.size_t(len(rays)), query)
	})
	return counts, err
}

// Save saves the committed scene; a file of that name stays whole until all is written.
func (s *Scene) Save(path string) error {
	name := C.CString(path)
	defer C.free(unsafe.Pointer(name))
	return s.call(func() C.kiwami_result {
		var desc C.kiwami_save_desc
		C.kiwami_save_desc_init(&desc, C.sizeof_kiwami_save_desc)
		desc.path = name
		return C.kiwami_scene_save(s.object, &desc, nil)
	})
}

// Ways to load a file.
const (
	LoadMap     = uint32(C.KIWAMI_LOAD_MAP)     // use the file where it lies; it may not change
	LoadTrusted = uint32(C.KIWAMI_LOAD_TRUSTED) // check nothing: only for files of one's own
)

// LoadScene loads a scene that Save wrote; flags are 0 or Load constants.
func LoadScene(device *Device, path string, flags uint32) (*Scene, error) {
	scene, err := NewScene(device)
	if err != nil {
		return nil, err
	}
	name := C.CString(path)
	defer C.free(unsafe.Pointer(name))
	var loaded *C.kiwami_scene
	err = scene.call(func() C.kiwami_result {
		var desc C.kiwami_load_desc
		C.kiwami_load_desc_init(&desc, C.sizeof_kiwami_load_desc)
		desc.path = name
		desc.flags = C.uint32_t(flags)
		return C.kiwami_scene_load(scene.device, &desc, &loaded)
	})
	if err != nil {
		scene.Close()
		return nil, err
	}
	C.kiwami_scene_release(scene.object)
	scene.object = loaded
	return scene, nil
}
