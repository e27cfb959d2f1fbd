// SPDX-License-Identifier: Apache-2.0

// Package kiwami traces rays on CPUs: exactly, the same to the bit everywhere, in batches.
//
//	scene, err := kiwami.NewScene(nil)
//	scene.AddMesh(vertices, triangles, kiwami.AllMasks)
//	err = scene.Commit()
//	hits, err := scene.ClosestHit(rays)
//
// Objects end with Close, or when the garbage collector finds them. A committed scene can be traced
// from any number of goroutines at once; changes to it come from one at a time.
package kiwami

/*
#cgo LDFLAGS: -lkiwami
#include <kiwami/kiwami.h>
#include <stdlib.h>
*/
import "C"

import (
	"runtime"
	"unsafe"
)

// InvalidID is the number that names nothing.
const InvalidID = uint32(C.KIWAMI_INVALID_ID)

// AllMasks is the mask of a mesh that every ray meets.
const AllMasks = ^uint32(0)

// Flags of rays.
const (
	CullBackFaces  = uint32(C.KIWAMI_RAY_CULL_BACK_FACES)
	CullFrontFaces = uint32(C.KIWAMI_RAY_CULL_FRONT_FACES)
)

// Error is an error of the library: its number and its sentence, and, where a callback failed, what
// it returned or panicked with.
type Error struct {
	Result   int32
	Sentence string
	Cause    error
}

func (e *Error) Error() string { return e.Sentence }

// Unwrap gives the cause, for errors.Is and errors.As.
func (e *Error) Unwrap() error { return e.Cause }

// check turns a result into an error. The sentence belongs to the operating system's thread, so
// callers lock theirs to it.
func check(result C.kiwami_result, device *C.kiwami_device) error {
	if result == C.KIWAMI_OK {
		return nil
	}
	var text [1024]C.char
	C.kiwami_last_error(device, &text[0], C.size_t(len(text)))
	sentence := C.GoString(&text[0])
	if sentence == "" {
		sentence = C.GoString(C.kiwami_result_name(result))
	}
	return &Error{int32(result), sentence, nil}
}

// onOneThread runs a call and the reading of its error on one thread.
func onOneThread(call func() error) error {
	runtime.LockOSThread()
	defer runtime.UnlockOSThread()
	return call()
}

// ISA names an instruction set.
type ISA uint32

// Instruction sets.
const (
	ISAAuto   = ISA(C.KIWAMI_ISA_AUTO)
	ISAScalar = ISA(C.KIWAMI_ISA_SCALAR)
	ISASSE    = ISA(C.KIWAMI_ISA_SSE)
	ISAAVX2   = ISA(C.KIWAMI_ISA_AVX2)
	ISAAVX512 = ISA(C.KIWAMI_ISA_AVX512)
)

// DeviceOptions says how a device is to be made; its zero value is the default.
type DeviceOptions struct {
	ISA         ISA
	ThreadCount uint32 // 0: one per processor
	Validate    bool   // check the arguments of the trace calls in the library too
}

// Device is the kernels of one instruction set and the threads that run them.
type Device struct {
	object *C.kiwami_device
}

// NewDevice makes a device; nil stands for the defaults.
func NewDevice(options *DeviceOptions) (*Device, error) {
	var desc C.kiwami_device_desc
	device := &Device{}
	err := onOneThread(func() error {
		if err := check(C.kiwami_device_desc_init(&desc, C.sizeof_kiwami_device_desc), nil); err != nil {
			return err
		}
		if options != nil {
			desc.isa = C.uint32_t(options.ISA)
			desc.thread_count = C.uint32_t(options.ThreadCount)
			if options.Validate {
				desc.flags = C.KIWAMI_DEVICE_VALIDATE
			}
		}
		return check(C.kiwami_device_create(&desc, &device.object), nil)
	})
	if err != nil {
		return nil, err
	}
	runtime.SetFinalizer(device, (*Device).Close)
	return device, nil
}

// Close lets go of the device; scenes of it live on. Closing twice is allowed.
func (d *Device) Close() {
	C.kiwami_device_release(d.object)
	d.object = nil
	runtime.SetFinalizer(d, nil)
}

// ISAName is the lower-case name of the instruction set whose kernels run.
func (d *Device) ISAName() string {
	info := C.kiwami_device_info{struct_size: C.sizeof_kiwami_device_info}
	C.kiwami_device_get_info(d.object, &info)
	runtime.KeepAlive(d)
	return C.GoString(C.kiwami_isa_name(info.isa))
}

// Ray is the points Origin + t * Direction with TMin <= t <= TMax, laid out as in C.
type Ray struct {
	Origin    [3]float32
	TMin      float32
	Direction [3]float32
	TMax      float32
	Time      float32
	Mask      uint32
	Flags     uint32
	ID        uint32 // the caller's own; not read
}

// Hit is the answer to a ray, laid out as in C. A miss has an infinite T and InvalidID thrice.
type Hit struct {
	T           float32
	U, V        float32
	Normal      [3]float32
	PrimitiveID uint32
	GeometryID  uint32
	InstanceID  uint32
}

// IsHit says whether the ray hit anything.
func (h Hit) IsHit() bool { return h.PrimitiveID != InvalidID }

// The build fails where the layouts differ from those of C.
var (
	_ [C.sizeof_kiwami_ray]byte = [unsafe.Sizeof(Ray{})]byte{}
	_ [C.sizeof_kiwami_hit]byte = [unsafe.Sizeof(Hit{})]byte{}
)
