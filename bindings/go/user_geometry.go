// SPDX-License-Identifier: Apache-2.0

package kiwami

/*
#include "callbacks.h"
*/
import "C"

import (
	"runtime/cgo"
	"sync"
	"sync/atomic"
	"unsafe"
)

// Box is a box around a primitive.
type Box struct {
	Lower, Upper [3]float32
}

// UserHit is a point where a ray meets a primitive.
type UserHit struct {
	T           float32
	U, V        float32    // whatever the primitives' kind makes of them
	Normal      [3]float32 // outward; need not have length 1
	PrimitiveID uint32     // one of those that were asked for
	_           uint32
}

// The build fails where the layouts differ from those of C.
var (
	_ [6 * 4]byte                    = [unsafe.Sizeof(Box{})]byte{}
	_ [C.sizeof_kiwami_user_hit]byte = [unsafe.Sizeof(UserHit{})]byte{}
)

// Intersection is one ray and the primitives that it may meet. It ends with the call.
type Intersection struct {
	Ray          Ray // in the geometry's space; TMax may be nearer than the traced ray's
	GeometryID   uint32
	PrimitiveIDs []uint32

	asked *C.kiwami_user_intersection
}

// Add adds a hit of one of the primitives, of which each has at most four: it panics beyond. Where
// Ray.TMin <= T <= Ray.TMax does not hold the hit is ignored.
func (i *Intersection) Add(hit UserHit) {
	if i.asked.hit_count == i.asked.hit_capacity {
		panic("more than four hits a primitive")
	}
	hits := unsafe.Slice((*UserHit)(unsafe.Pointer(i.asked.hits)), int(i.asked.hit_capacity))
	hits[i.asked.hit_count] = hit
	i.asked.hit_count++
}

// UserGeometry is primitives of the caller's own kind. Several threads ask it at once. An error or a
// panic ends the commit or the trace call, whose Error has it as its Cause.
type UserGeometry interface {
	// Bounds writes a box for each of the primitives from first on.
	Bounds(first uint32, boxes []Box) error
	// Intersect adds the hits of a ray. Those of a primitive must depend on the ray and the
	// primitive alone, and lie in its box.
	Intersect(intersection *Intersection) error
}

// AddUserGeometry adds count primitives, which are kept until no scene uses them any more; returns
// the number that hits report as GeometryID. Only a ray with ray.Mask & mask != 0 meets them.
func (s *Scene) AddUserGeometry(count uint64, primitives UserGeometry, mask uint32) (uint32, error) {
	handle := cgo.NewHandle(primitives)
	isOwned := false
	number, err := s.add(func(geometry **C.kiwami_geometry) C.kiwami_result {
		result := C.kiwami_go_user_geometry_create(s.device, C.uint64_t(count), C.uint32_t(mask),
			C.uintptr_t(handle), geometry)
		if result == C.KIWAMI_OK {
			isOwned = true
			atomic.AddInt64(&userErrors.geometries, 1)
		}
		return result
	}, attached{})
	if !isOwned {
		handle.Delete()
	}
	return number, err
}

//export kiwamiGoBounds
func kiwamiGoBounds(handle C.uintptr_t, first, count C.uint32_t, boxes *C.float) C.int32_t {
	return userErrors.result(guarded(func() error {
		primitives := cgo.Handle(handle).Value().(UserGeometry)
		return primitives.Bounds(uint32(first), unsafe.Slice((*Box)(unsafe.Pointer(boxes)), int(count)))
	}))
}

//export kiwamiGoIntersect
func kiwamiGoIntersect(handle C.uintptr_t, asked *C.kiwami_user_intersection) C.int32_t {
	return userErrors.result(guarded(func() error {
		primitives := cgo.Handle(handle).Value().(UserGeometry)
		ids := (*uint32)(unsafe.Pointer(asked.primitive_ids))
		return primitives.Intersect(&Intersection{
			Ray:          *(*Ray)(unsafe.Pointer(asked.ray)),
			GeometryID:   uint32(asked.geometry_id),
			PrimitiveIDs: unsafe.Slice(ids, int(asked.primitive_count)),
			asked:        asked,
		})
	}))
}

//export kiwamiGoDestroy
func kiwamiGoDestroy(handle C.uintptr_t) {
	cgo.Handle(handle).Delete()
	atomic.AddInt64(&userErrors.geometries, -1)
}

// userErrors are the errors of user geometries. The library does not say for which call they run, so
// an error is kept for all calls that do: one that fails has the first since it began.
var userErrors errorsOfCalls

type errorsOfCalls struct {
	geometries int64 // that live; without any no call need be counted

	mutex            sync.Mutex
	running          int
	clock, lastBegin uint64
	kept             []keptError
}

type keptError struct {
	when uint64
	err  error
}

// result is what a callback returns to C; an error is kept.
func (e *errorsOfCalls) result(err error) C.int32_t {
	if err == nil {
		return 0
	}
	e.mutex.Lock()
	defer e.mutex.Unlock()
	if len(e.kept) == 0 || e.kept[len(e.kept)-1].when < e.lastBegin {
		e.clock++
		e.kept = append(e.kept, keptError{e.clock, err})
	}
	return -1
}

func (e *errorsOfCalls) begin() uint64 {
	e.mutex.Lock()
	defer e.mutex.Unlock()
	e.running++
	e.clock++
	e.lastBegin = e.clock
	return e.clock
}

// end ends the call that began then, and gives the first error since.
func (e *errorsOfCalls) end(begin uint64) (first error) {
	e.mutex.Lock()
	defer e.mutex.Unlock()
	for _, each := range e.kept {
		if each.when > begin {
			first = each.err
			break
		}
	}
	e.running--
	if e.running == 0 {
		e.kept = nil
	}
	return first
}

// callWithCallbacks is call, for what may run callbacks: those of user geometries, and others of its
// own, whose first error goes first.
func (s *Scene) callWithCallbacks(own *firstError, body func() C.kiwami_result) error {
	if atomic.LoadInt64(&userErrors.geometries) == 0 {
		return withCause(s.call(body), own.err)
	}
	begin := userErrors.begin()
	err := s.call(body)
	cause := userErrors.end(begin)
	failed, isOwn := err.(*Error)
	if own.err != nil {
		cause = own.err
	} else if !isOwn || failed.Result != C.KIWAMI_ERROR_CALLBACK {
		cause = nil // the error has another reason
	}
	return withCause(err, cause)
}
