// SPDX-License-Identifier: Apache-2.0

package kiwami

/*
#include <stdlib.h>
#include <string.h>
*/
import "C"

import "unsafe"

// pinned holds copies in C's memory. A descriptor that lies in Go's memory may not point at other
// Go memory when it is given to C, and pinning is not to be had before Go 1.21.
type pinned struct {
	copies []unsafe.Pointer
}

// copy returns a copy of size bytes; never nil, which would stand for a missing buffer.
func (p *pinned) copy(from unsafe.Pointer, size int) unsafe.Pointer {
	made := C.malloc(C.size_t(size + 1))
	if from != nil {
		C.memcpy(made, from, C.size_t(size))
	}
	p.copies = append(p.copies, made)
	return made
}

func (p *pinned) free() {
	for _, each := range p.copies {
		C.free(each)
	}
}
