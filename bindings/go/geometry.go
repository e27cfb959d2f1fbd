// SPDX-License-Identifier: Apache-2.0

package kiwami

/*
#include <kiwami/kiwami.h>
*/
import "C"

import (
	"fmt"
	"runtime"
	"unsafe"
)

// attached is what the scene remembers of a geometry.
type attached struct {
	geometry    *C.kiwami_geometry
	isMesh      bool
	vertexCount int
}

// add makes a geometry, attaches it, and returns the number that hits report.
func (s *Scene) add(create func(**C.kiwami_geometry) C.kiwami_result, made attached) (uint32, error) {
	var number C.uint32_t
	err := s.call(func() C.kiwami_result {
		var geometry *C.kiwami_geometry
		result := create(&geometry)
		if result != C.KIWAMI_OK {
			return result
		}
		result = C.kiwami_scene_attach(s.object, geometry, &number)
		if result != C.KIWAMI_OK {
			C.kiwami_geometry_release(geometry)
			return result
		}
		made.geometry = geometry
		s.attached[uint32(number)] = made
		return result
	})
	return uint32(number), err
}

func invalid(format string, values ...any) error {
	return &Error{C.KIWAMI_ERROR_INVALID_ARGUMENT, fmt.Sprintf(format, values...), nil}
}

// AddMesh adds a mesh, copied, and returns the number that hits report as GeometryID. Only a ray
// with ray.Mask & mask != 0 meets it.
func (s *Scene) AddMesh(vertices [][3]float32, triangles [][3]uint32, mask uint32) (uint32, error) {
	return s.add(func(geometry **C.kiwami_geometry) C.kiwami_result {
		var desc C.kiwami_triangle_mesh_desc
		C.kiwami_triangle_mesh_desc_init(&desc, C.sizeof_kiwami_triangle_mesh_desc)
		// Go's memory may not be held by C's, so the buffers are pinned while the library copies.
		var pinner pinned
		defer pinner.free()
		desc.vertices = pinner.copy(address(vertices), len(vertices)*12)
		desc.vertex_count = C.uint64_t(len(vertices))
		desc.indices = pinner.copy(address(triangles), len(triangles)*12)
		desc.triangle_count = C.uint64_t(len(triangles))
		desc.mask = C.uint32_t(mask)
		return C.kiwami_triangle_mesh_create(s.device, &desc, geometry)
	}, attached{isMesh: true, vertexCount: len(vertices)})
}

// AddMovingMesh adds a mesh whose vertices move from step to step between two times; all steps have
// as many vertices. It returns its number as AddMesh does.
func (s *Scene) AddMovingMesh(steps [][][3]float32, triangles [][3]uint32, timeBegin, timeEnd float32,
	mask uint32) (uint32, error) {
	var vertices [][3]float32
	for i, step := range steps {
		if len(step) != len(steps[0]) {
			return 0, invalid("step %d has %d vertices, expected %d", i, len(step), len(steps[0]))
		}
		vertices = append(vertices, step...)
	}
	return s.add(func(geometry **C.kiwami_geometry) C.kiwami_result {
		var desc C.kiwami_moving_mesh_desc
		C.kiwami_moving_mesh_desc_init(&desc, C.sizeof_kiwami_moving_mesh_desc)
		var pinner pinned
		defer pinner.free()
		desc.vertices = pinner.copy(address(vertices), len(vertices)*12)
		if len(steps) > 0 {
			desc.vertex_count = C.uint64_t(len(steps[0]))
		}
		desc.indices = pinner.copy(address(triangles), len(triangles)*12)
		desc.triangle_count = C.uint64_t(len(triangles))
		desc.step_count = C.uint32_t(len(steps))
		desc.time_begin, desc.time_end = C.float(timeBegin), C.float(timeEnd)
		desc.mask = C.uint32_t(mask)
		return C.kiwami_moving_mesh_create(s.device, &desc, geometry)
	}, attached{})
}

// AddSpheres adds spheres of x, y, z and radius.
func (s *Scene) AddSpheres(points [][4]float32, mask uint32) (uint32, error) {
	return s.add(func(geometry **C.kiwami_geometry) C.kiwami_result {
		var desc C.kiwami_spheres_desc
		C.kiwami_spheres_desc_init(&desc, C.sizeof_kiwami_spheres_desc)
		var pinner pinned
		defer pinner.free()
		desc.points = pinner.copy(address(points), len(points)*16)
		desc.sphere_count = C.uint64_t(len(points))
		desc.mask = C.uint32_t(mask)
		return C.kiwami_spheres_create(s.device, &desc, geometry)
	}, attached{})
}

// AddDiscs adds flat discs, as many points as normals.
func (s *Scene) AddDiscs(points [][4]float32, normals [][3]float32, mask uint32) (uint32, error) {
	if len(points) != len(normals) {
		return 0, invalid("there are %d normals, expected %d", len(normals), len(points))
	}
	return s.add(func(geometry **C.kiwami_geometry) C.kiwami_result {
		var desc C.kiwami_discs_desc
		C.kiwami_discs_desc_init(&desc, C.sizeof_kiwami_discs_desc)
		var pinner pinned
		defer pinner.free()
		desc.points = pinner.copy(address(points), len(points)*16)
		desc.normals = pinner.copy(address(normals), len(normals)*12)
		desc.disc_count = C.uint64_t(len(points))
		desc.mask = C.uint32_t(mask)
		return C.kiwami_discs_create(s.device, &desc, geometry)
	}, attached{})
}

// AddCurves adds round curve segments: segment i joins the points segments[i] and segments[i] + 1.
func (s *Scene) AddCurves(points [][4]float32, segments []uint32, mask uint32) (uint32, error) {
	return s.add(func(geometry **C.kiwami_geometry) C.kiwami_result {
		var desc C.kiwami_curves_desc
		C.kiwami_curves_desc_init(&desc, C.sizeof_kiwami_curves_desc)
		var pinner pinned
		defer pinner.free()
		desc.points = pinner.copy(address(points), len(points)*16)
		desc.point_count = C.uint64_t(len(points))
		desc.indices = pinner.copy(address(segments), len(segments)*4)
		desc.segment_count = C.uint64_t(len(segments))
		desc.mask = C.uint32_t(mask)
		return C.kiwami_curves_create(s.device, &desc, geometry)
	}, attached{})
}

// Instance is one of several scenes, shown at another place.
type Instance struct {
	Scene     uint32        // the index of the scene that it shows
	Mask      uint32        // a ray enters only if ray.Mask & Mask != 0
	Transform [3][4]float32 // from the scene's space to the outer one
}

// AddInstances adds instances of these scenes. A commit shows what they have committed by then, and
// may not overlap with theirs.
func (s *Scene) AddInstances(scenes []*Scene, instances []Instance, mask uint32) (uint32, error) {
	shown := make([]*C.kiwami_scene, len(scenes))
	for i, scene := range scenes {
		if scene == nil || scene.object == nil {
			return 0, invalid("scene %d is closed", i)
		}
		shown[i] = scene.object
	}
	defer runtime.KeepAlive(scenes)
	return s.add(func(geometry **C.kiwami_geometry) C.kiwami_result {
		var desc C.kiwami_instances_desc
		C.kiwami_instances_desc_init(&desc, C.sizeof_kiwami_instances_desc)
		var pinner pinned
		defer pinner.free()
		const stride = unsafe.Sizeof(Instance{})
		desc.scenes = (**C.kiwami_scene)(pinner.copy(address(shown), len(shown)*int(unsafe.Sizeof(s.object))))
		desc.scene_count = C.uint64_t(len(shown))
		first := (*Instance)(pinner.copy(address(instances), len(instances)*int(stride)))
		desc.count = C.uint64_t(len(instances))
		desc.scene_indices, desc.scene_index_stride = unsafe.Pointer(&first.Scene), C.uint64_t(stride)
		desc.masks, desc.mask_stride = unsafe.Pointer(&first.Mask), C.uint64_t(stride)
		desc.transforms, desc.transform_stride = unsafe.Pointer(&first.Transform), C.uint64_t(stride)
		desc.mask = C.uint32_t(mask)
		return C.kiwami_instances_create(s.device, &desc, geometry)
	}, attached{})
}

// UpdateVertices gives a mesh other vertices, as many as it has; Refit or Commit shows them.
func (s *Scene) UpdateVertices(geometryID uint32, vertices [][3]float32) error {
	mesh := s.attached[geometryID]
	if !mesh.isMesh {
		return invalid("geometryID is %d, expected that of a mesh", geometryID)
	}
	if len(vertices) != mesh.vertexCount {
		return invalid("there are %d vertices, expected %d", len(vertices), mesh.vertexCount)
	}
	return s.call(func() C.kiwami_result {
		return C.kiwami_triangle_mesh_update_vertices(mesh.geometry, address(vertices), 0, 0)
	})
}

// Enable leaves a geometry out, or takes it in again, under its number.
func (s *Scene) Enable(geometryID uint32, isEnabled bool) error {
	return s.call(func() C.kiwami_result {
		var number C.int32_t
		if isEnabled {
			number = 1
		}
		return C.kiwami_scene_enable(s.object, C.uint32_t(geometryID), number)
	})
}

// Remove removes a geometry; its number becomes free.
func (s *Scene) Remove(geometryID uint32) error {
	return s.call(func() C.kiwami_result {
		result := C.kiwami_scene_detach(s.object, C.uint32_t(geometryID))
		if result == C.KIWAMI_OK {
			C.kiwami_geometry_release(s.attached[geometryID].geometry)
			delete(s.attached, geometryID)
		}
		return result
	})
}
