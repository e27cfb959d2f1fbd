// SPDX-License-Identifier: Apache-2.0

package kiwami

/*
#include <kiwami/kiwami.h>
*/
import "C"

import (
	"runtime"
	"unsafe"
)

// Kinds of lights.
const (
	LightPoint       = uint32(C.KIWAMI_LIGHT_POINT)
	LightSpot        = uint32(C.KIWAMI_LIGHT_SPOT)
	LightTriangle    = uint32(C.KIWAMI_LIGHT_TRIANGLE)
	LightQuad        = uint32(C.KIWAMI_LIGHT_QUAD)
	LightSphere      = uint32(C.KIWAMI_LIGHT_SPHERE)
	LightDisc        = uint32(C.KIWAMI_LIGHT_DISC)
	LightDistant     = uint32(C.KIWAMI_LIGHT_DISTANT)
	LightEnvironment = uint32(C.KIWAMI_LIGHT_ENVIRONMENT)
)

// LightTwoSided is a flag of triangles, quads and discs.
const LightTwoSided = uint32(C.KIWAMI_LIGHT_TWO_SIDED)

// ReceiverBothSides is a flag of receivers that take light from both sides.
const ReceiverBothSides = uint32(C.KIWAMI_RECEIVER_BOTH_SIDES)

// AllLinks is a link mask that shares a bit with all others but 0.
const AllLinks = ^uint64(0)

// Light is a light, laid out as in C: see kiwami_light of light.h for which fields each kind has.
type Light struct {
	Kind      uint32
	Flags     uint32
	Points    [4][3]float32
	Direction [3]float32
	Radius    float32
	CosInner  float32
	CosOuter  float32
	Power     float32 // only ratios count
	UserID    uint32  // the caller's own; copied to the choices
	LinkMask  uint64  // lights a receiver only if LinkMask & receiver.LinkMask != 0
}

// LightReceiver is who asks for a light: a point with a normal, a point without, or a segment.
type LightReceiver struct {
	Position [3]float32
	Normal   [3]float32 // 0, 0, 0: none
	Segment  [3]float32 // from Position to the other end; 0, 0, 0: a point
	Flags    uint32
	LinkMask uint64
	Random   float64 // at least 0, below 1
}

// LightChoice is a light that was chosen.
type LightChoice struct {
	LightID     uint32 // InvalidID: none
	InstanceID  uint32 // the instance through which it is seen; InvalidID: none
	UserID      uint32
	Probability float32 // with which this choice was made
	Random      float64 // a new random number, for a point on the light
}

// The build fails where the layouts differ from those of C.
var (
	_ [C.sizeof_kiwami_light]byte          = [unsafe.Sizeof(Light{})]byte{}
	_ [C.sizeof_kiwami_light_receiver]byte = [unsafe.Sizeof(LightReceiver{})]byte{}
	_ [C.sizeof_kiwami_light_choice]byte   = [unsafe.Sizeof(LightChoice{})]byte{}
)

// LightTree is lights, among which points choose in proportion to what may reach them. Changes take
// effect with Commit or Refit.
type LightTree struct {
	object *C.kiwami_light_tree
	device *C.kiwami_device
}

// NewLightTree makes an empty set with nodes of 2, 4, 8 or 16 children (0: the device's default).
func NewLightTree(device *Device, width uint32) (*LightTree, error) {
	if device == nil {
		own, err := NewDevice(nil)
		if err != nil {
			return nil, err
		}
		defer own.Close() // the set holds it
		device = own
	}
	tree := &LightTree{}
	err := onOneThread(func() error {
		var desc C.kiwami_light_tree_desc
		C.kiwami_light_tree_desc_init(&desc, C.sizeof_kiwami_light_tree_desc)
		desc.width = C.uint32_t(width)
		return check(C.kiwami_light_tree_create(device.object, &desc, &tree.object), device.object)
	})
	if err != nil {
		return nil, err
	}
	tree.device = device.object
	C.kiwami_device_retain(tree.device)
	runtime.SetFinalizer(tree, (*LightTree).Close)
	return tree, nil
}

// Close lets go of the set. Closing twice is allowed.
func (l *LightTree) Close() {
	C.kiwami_light_tree_release(l.object)
	C.kiwami_device_release(l.device)
	l.object, l.device = nil, nil
	runtime.SetFinalizer(l, nil)
}

func (l *LightTree) call(body func() C.kiwami_result) error {
	if l.object == nil {
		return &Error{C.KIWAMI_ERROR_INVALID_STATE, "the set of lights is closed", nil}
	}
	defer runtime.KeepAlive(l)
	return onOneThread(func() error { return check(body(), l.device) })
}

// AddLights adds lights and returns the number of the first.
func (l *LightTree) AddLights(lights []Light) (uint32, error) {
	var first C.uint32_t
	err := l.call(func() C.kiwami_result {
		return C.kiwami_light_tree_add_lights(l.object, (*C.kiwami_light)(address(lights)), 0,
			C.size_t(len(lights)), &first)
	})
	return uint32(first), err
}

// AddMesh makes a light of each triangle and returns the number of the first.
func (l *LightTree) AddMesh(vertices [][3]float32, triangles [][3]uint32, radiance float32,
	isTwoSided bool) (uint32, error) {
	var first C.uint32_t
	err := l.call(func() C.kiwami_result {
		var desc C.kiwami_light_mesh_desc
		C.kiwami_light_mesh_desc_init(&desc, C.sizeof_kiwami_light_mesh_desc)
		var pinner pinned
		defer pinner.free()
		if isTwoSided {
			desc.flags = C.KIWAMI_LIGHT_TWO_SIDED
		}
		desc.vertices = pinner.copy(address(vertices), len(vertices)*12)
		desc.vertex_count = C.uint64_t(len(vertices))
		desc.indices = pinner.copy(address(triangles), len(triangles)*12)
		desc.triangle_count = C.uint64_t(len(triangles))
		desc.radiance = C.float(radiance)
		return C.kiwami_light_tree_add_mesh(l.object, &desc, &first)
	})
	return uint32(first), err
}

// SetPowers gives the lights from first on other powers.
func (l *LightTree) SetPowers(first uint32, powers []float32) error {
	return l.call(func() C.kiwami_result {
		return C.kiwami_light_tree_set_powers(l.object, C.uint32_t(first),
			(*C.float)(address(powers)), 0, C.size_t(len(powers)))
	})
}

// Commit builds the tree over all lights.
func (l *LightTree) Commit() error {
	return l.call(func() C.kiwami_result { return C.kiwami_light_tree_commit(l.object) })
}

// Refit is Commit, but keeps the shape of the tree.
func (l *LightTree) Refit() error {
	return l.call(func() C.kiwami_result { return C.kiwami_light_tree_refit(l.object) })
}

// Sample lets each receiver choose a light.
func (l *LightTree) Sample(receivers []LightReceiver) ([]LightChoice, error) {
	choices := make([]LightChoice, len(receivers))
	err := l.call(func() C.kiwami_result {
		return C.kiwami_light_sample(l.object, (*C.kiwami_light_receiver)(address(receivers)), 0,
			(*C.kiwami_light_choice)(address(choices)), 0, C.size_t(len(receivers)), nil)
	})
	return choices, err
}

// PDF gives the probability with which each receiver chooses the light of the choice beside it.
func (l *LightTree) PDF(receivers []LightReceiver, lights []LightChoice) ([]float32, error) {
	if len(lights) != len(receivers) {
		return nil, invalid("there are %d lights, expected %d", len(lights), len(receivers))
	}
	probabilities := make([]float32, len(receivers))
	err := l.call(func() C.kiwami_result {
		// A choice begins with the name of its light.
		return C.kiwami_light_pdf(l.object, (*C.kiwami_light_receiver)(address(receivers)), 0,
			(*C.kiwami_light_name)(address(lights)), C.sizeof_kiwami_light_choice,
			(*C.float)(address(probabilities)), 0, C.size_t(len(receivers)), nil)
	})
	return probabilities, err
}
