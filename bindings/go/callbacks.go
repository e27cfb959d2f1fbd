// SPDX-License-Identifier: Apache-2.0

package kiwami

/*
#include "callbacks.h"
*/
import "C"

import (
	"fmt"
	"runtime/cgo"
	"sync"
	"unsafe"
)

// PanicError is what a callback panicked with, as the Cause of the error of the call.
type PanicError struct {
	Value any
}

func (e *PanicError) Error() string { return fmt.Sprint("panic: ", e.Value) }

// guarded runs a callback; a panic, which may not cross C, becomes an error.
func guarded(body func() error) (err error) {
	defer func() {
		if value := recover(); value != nil {
			err = &PanicError{value}
		}
	}()
	return body()
}

// withCause says why a call failed, where one of its callbacks did.
func withCause(err, cause error) error {
	failed, isOwn := err.(*Error)
	if !isOwn || cause == nil {
		return err
	}
	return &Error{failed.Result, failed.Sentence + ": " + cause.Error(), cause}
}

// firstError keeps the first error of callbacks that run on several threads.
type firstError struct {
	mutex sync.Mutex
	err   error
}

func (f *firstError) keep(err error) {
	f.mutex.Lock()
	defer f.mutex.Unlock()
	if f.err == nil {
		f.err = err
	}
}

// Candidate is what a filter is asked about: a hit that TMin, TMax, masks and sides leave.
type Candidate struct {
	Ray          uint64 // the number of the ray in the call
	Hit          Hit
	InstancePath []uint32 // the numbers of the instances that lead to the hit, the outermost first
}

// Answer is what a filter says.
type Answer int32

// Answers of filters.
const (
	Reject        = Answer(C.KIWAMI_FILTER_REJECT) // the hit is none
	Accept        = Answer(C.KIWAMI_FILTER_ACCEPT)
	AcceptAndStop = Answer(C.KIWAMI_FILTER_ACCEPT_AND_STOP) // nothing more is looked for along the ray
)

// Filter decides whether a hit counts. Several threads ask it at once. An error or a panic ends the
// call, whose Error has it as its Cause.
type Filter func(candidate *Candidate) (Answer, error)

type runningFilter struct {
	function Filter
	failed   firstError
}

//export kiwamiGoFilter
func kiwamiGoFilter(handle C.uintptr_t, candidate *C.kiwami_filter_candidate) C.int32_t {
	running := cgo.Handle(handle).Value().(*runningFilter)
	answer := Answer(-1)
	err := guarded(func() (err error) {
		asked := Candidate{
			Ray: uint64(candidate.ray),
			Hit: *(*Hit)(unsafe.Pointer(&candidate.hit)),
		}
		for _, each := range candidate.instance_path[:candidate.depth] {
			asked.InstancePath = append(asked.InstancePath, uint32(each))
		}
		answer, err = running.function(&asked)
		return err
	})
	if err != nil {
		running.failed.keep(err)
		return -1
	}
	return C.int32_t(answer)
}

// Option is what a trace call may be told beyond the rays.
type Option func(*traceOptions)

type traceOptions struct {
	filter Filter
}

// WithFilter has a function decide which hits count.
func WithFilter(filter Filter) Option {
	return func(options *traceOptions) { options.filter = filter }
}

// trace runs a trace call with these options.
func (s *Scene) trace(options []Option, body func(query *C.kiwami_query) C.kiwami_result) error {
	var chosen traceOptions
	for _, each := range options {
		each(&chosen)
	}
	if chosen.filter == nil {
		return s.callWithCallbacks(&firstError{}, func() C.kiwami_result { return body(nil) })
	}
	running := &runningFilter{function: chosen.filter}
	handle := cgo.NewHandle(running)
	defer handle.Delete()
	var memory pinned
	defer memory.free()
	query := (*C.kiwami_query)(memory.copy(nil, C.sizeof_kiwami_query))
	C.kiwami_go_query_init(query, C.uintptr_t(handle))
	return s.callWithCallbacks(&running.failed, func() C.kiwami_result { return body(query) })
}

type runningProgress struct {
	function func(fraction float64) error
	failed   firstError
}

//export kiwamiGoProgress
func kiwamiGoProgress(handle C.uintptr_t, fraction C.double) C.int32_t {
	running := cgo.Handle(handle).Value().(*runningProgress)
	if running.failed.err == nil {
		running.failed.err = guarded(func() error { return running.function(float64(fraction)) })
	}
	if running.failed.err != nil {
		return 1
	}
	return 0
}

// CommitWithProgress is Commit, and tells the function how far it is: a fraction from 0 to 1, which
// never falls, from any thread, never from two at a time. Where it returns an error or panics, the
// commit ends with an Error that has it as its Cause; what was committed before stays in use.
func (s *Scene) CommitWithProgress(progress func(fraction float64) error) error {
	running := &runningProgress{function: progress}
	handle := cgo.NewHandle(running)
	defer handle.Delete()
	return s.callWithCallbacks(&running.failed, func() C.kiwami_result {
		C.kiwami_go_set_progress(s.object, C.uintptr_t(handle))
		defer C.kiwami_go_set_progress(s.object, 0)
		return C.kiwami_scene_commit(s.object)
	})
}
