// SPDX-License-Identifier: Apache-2.0

package kiwami

import (
	"errors"
	"fmt"
	"runtime"
	"strings"
	"sync"
	"testing"
	"time"
)

var errOwn = errors.New("an error of the caller's own")

func rayAt(x, y float32) Ray { return NewRay([3]float32{x, y, -1}, [3]float32{0, 0, 1}) }

func rays(count int, ray Ray) []Ray {
	made := make([]Ray, count)
	for i := range made {
		made[i] = ray
	}
	return made
}

// layers is eight triangles, one behind the other.
func layers(t *testing.T) *Scene {
	scene, err := NewScene(nil)
	if err != nil {
		t.Fatal(err)
	}
	var vertices [][3]float32
	var triangles [][3]uint32
	for i := uint32(0); i < 8; i++ {
		z := float32(i)
		vertices = append(vertices, [][3]float32{{-1, -1, z}, {3, -1, z}, {-1, 3, z}}...)
		triangles = append(triangles, [3]uint32{3 * i, 3*i + 1, 3*i + 2})
	}
	if _, err := scene.AddMesh(vertices, triangles, AllMasks); err != nil {
		t.Fatal(err)
	}
	if err := scene.Commit(); err != nil {
		t.Fatal(err)
	}
	return scene
}

// every runs each kind of trace call.
func every(scene *Scene, rays []Ray, options ...Option) map[string]error {
	_, closest := scene.ClosestHit(rays, options...)
	_, any := scene.AnyHit(rays, options...)
	_, multi := scene.MultiHit(rays, 0, options...)
	_, count := scene.CountHits(rays, options...)
	return map[string]error{"closest": closest, "any": any, "multi": multi, "count": count}
}

func TestFiltersAcceptRejectAndStop(t *testing.T) {
	scene := layers(t)
	defer scene.Close()
	many := rays(3000, rayAt(0, 0))
	odd := WithFilter(func(candidate *Candidate) (Answer, error) {
		if candidate.Ray >= 3000 || len(candidate.InstancePath) != 0 {
			return Reject, errOwn
		}
		if candidate.Hit.PrimitiveID%2 == 1 {
			return Accept, nil
		}
		return Reject, nil
	})
	hits, err := scene.ClosestHit(many, odd)
	if err != nil || hits[0].PrimitiveID != 1 || hits[2999].T != 2 {
		t.Error(hits[2999], err)
	}
	occluded, err := scene.AnyHit(many, odd)
	if err != nil || !occluded[2999] {
		t.Error("any hit", err)
	}
	counts, err := scene.CountHits(many, odd)
	if err != nil || counts[2999] != 4 {
		t.Error(counts[2999], err)
	}
	found, err := scene.MultiHit(many, 0, odd)
	if err != nil || len(found.Of(2999)) != 4 || found.Of(2999)[3].PrimitiveID != 7 {
		t.Error(found.Of(2999), err)
	}
	counts, err = scene.CountHits(many, WithFilter(func(*Candidate) (Answer, error) {
		return AcceptAndStop, nil
	}))
	if err != nil || counts[0] != 1 {
		t.Error(counts[0], err)
	}
	if !t.Failed() {
		note("filter callback")
	}
}

func TestWhatAFilterReturnsOrPanicsWithIsTheCause(t *testing.T) {
	scene := layers(t)
	defer scene.Close()
	many := rays(3000, rayAt(0, 0))
	fail := WithFilter(func(*Candidate) (Answer, error) { return Accept, errOwn })
	for name, err := range every(scene, many, fail) {
		if !errors.Is(err, errOwn) || !strings.HasSuffix(err.Error(), errOwn.Error()) {
			t.Errorf("%s: %v", name, err)
		}
	}
	for name, err := range every(scene, many, WithFilter(func(*Candidate) (Answer, error) { panic("no") })) {
		var value *PanicError
		if !errors.As(err, &value) || value.Value != "no" {
			t.Errorf("%s: %v", name, err)
		}
	}
	bad := WithFilter(func(*Candidate) (Answer, error) { return 7, nil })
	if _, err := scene.AnyHit(many, bad); err == nil || errors.Unwrap(err) != nil {
		t.Error(err)
	}
	if _, err := scene.AnyHit(many); err != nil {
		t.Error(err)
	}
}

func TestProgressIsToldAndMayCancelOrPanic(t *testing.T) {
	scene := layers(t)
	defer scene.Close()
	var fractions []float64
	err := scene.CommitWithProgress(func(fraction float64) error {
		fractions = append(fractions, fraction)
		return nil
	})
	last := len(fractions) - 1
	if err != nil || last < 1 || fractions[0] != 0 || fractions[last] != 1 {
		t.Fatal(fractions, err)
	}
	for i := range fractions[1:] {
		if fractions[i] > fractions[i+1] {
			t.Error(fractions)
		}
	}
	calls := 0
	err = scene.CommitWithProgress(func(float64) error {
		calls++
		return errOwn
	})
	if !errors.Is(err, errOwn) || calls != 1 {
		t.Error(calls, err)
	}
	var value *PanicError
	err = scene.CommitWithProgress(func(float64) error { panic(7) })
	if !errors.As(err, &value) || value.Value != 7 {
		t.Error(err)
	}
	// The function is gone, and what was committed before stays in use.
	if occluded, err := scene.AnyHit(rays(1, rayAt(0, 0))); err != nil || !occluded[0] {
		t.Error(err)
	}
	if err := scene.Commit(); err != nil || calls != 1 {
		t.Error(calls, err)
	}
	if !t.Failed() {
		note("progress callback")
	}
}

// squares are of side 2, across z = 0, 1, ...
type squares struct {
	failsInBounds bool
	failsAt       float32
	adds          int
}

func (s *squares) Bounds(first uint32, boxes []Box) error {
	for i := range boxes {
		z := float32(first + uint32(i))
		boxes[i] = Box{[3]float32{-1, -1, z}, [3]float32{1, 1, z}}
	}
	if s.failsInBounds {
		return errOwn
	}
	return nil
}

func (s *squares) Intersect(asked *Intersection) error {
	ray := asked.Ray
	if ray.Origin[0] == s.failsAt {
		panic(fmt.Sprint("no hit at ", s.failsAt))
	}
	for _, id := range asked.PrimitiveIDs {
		t := (float32(id) - ray.Origin[2]) / ray.Direction[2]
		x, y := ray.Origin[0]+t*ray.Direction[0], ray.Origin[1]+t*ray.Direction[1]
		if x < -1 || x > 1 || y < -1 || y > 1 {
			continue
		}
		for i := 0; i < s.adds; i++ {
			asked.Add(UserHit{T: t, U: x, V: y, Normal: [3]float32{0, 0, -1}, PrimitiveID: id})
		}
	}
	return nil
}

func sceneOf(t *testing.T, made *squares) *Scene {
	scene, err := NewScene(nil)
	if err != nil {
		t.Fatal(err)
	}
	if _, err := scene.AddUserGeometry(40, made, 2); err != nil {
		t.Fatal(err)
	}
	return scene
}

func TestUserGeometriesAreBoundedAndIntersected(t *testing.T) {
	isGone := make(chan bool, 1)
	made := &squares{failsAt: -5, adds: 1}
	runtime.SetFinalizer(made, func(*squares) { isGone <- true })
	scene := sceneOf(t, made)
	made = nil
	if err := scene.Commit(); err != nil {
		t.Fatal(err)
	}
	runtime.GC()
	many := rays(3000, rayAt(0.75, -0.5))
	hits, err := scene.ClosestHit(many)
	expected := Hit{1, 0.75, -0.5, [3]float32{0, 0, -1}, 0, 0, InvalidID}
	if err != nil || hits[2999] != expected {
		t.Error(hits[2999], err)
	}
	if counts, err := scene.CountHits(many); err != nil || counts[2999] != 40 {
		t.Error(counts[2999], err)
	}
	many[0].Mask, many[1] = 1, rayAt(1.5, 0)
	if occluded, err := scene.AnyHit(many); err != nil || occluded[0] || occluded[1] || !occluded[2] {
		t.Error(occluded[:3], err)
	}
	scene.Close()
	runtime.GC()
	select {
	case <-isGone:
	case <-time.After(20 * time.Second):
		t.Error("the primitives are still held")
	}
	if !t.Failed() {
		note("user geometry callback")
	}
}

func TestWhatAUserGeometryReturnsOrPanicsWithIsTheCause(t *testing.T) {
	scene := sceneOf(t, &squares{failsInBounds: true})
	if err := scene.Commit(); !errors.Is(err, errOwn) {
		t.Error(err)
	}
	if err := scene.CommitWithProgress(func(float64) error { return nil }); !errors.Is(err, errOwn) {
		t.Error(err)
	}
	scene.Close()
	scene = sceneOf(t, &squares{failsAt: 0.5, adds: 1})
	if err := scene.Commit(); err != nil {
		t.Fatal(err)
	}
	many := rays(3000, rayAt(0.25, 0))
	if _, err := scene.AnyHit(many); err != nil {
		t.Error(err)
	}
	many[2000] = rayAt(0.5, 0)
	for name, err := range every(scene, many) {
		var value *PanicError
		if !errors.As(err, &value) || value.Value != "no hit at 0.5" {
			t.Errorf("%s: %v", name, err)
		}
	}
	scene.Close()
	scene = sceneOf(t, &squares{failsAt: -5, adds: 100})
	defer scene.Close()
	if err := scene.Commit(); err != nil {
		t.Fatal(err)
	}
	if _, err := scene.AnyHit(many); err == nil || !strings.Contains(err.Error(), "four hits") {
		t.Error(err)
	}
	if _, err := scene.AddUserGeometry(1<<40, &squares{}, AllMasks); err == nil {
		t.Error("too many primitives were added")
	}
}

func TestEachOfManyCallsHasItsOwnError(t *testing.T) {
	scene := sceneOf(t, &squares{failsAt: 0.5, adds: 1})
	defer scene.Close()
	if err := scene.Commit(); err != nil {
		t.Fatal(err)
	}
	var group sync.WaitGroup
	for _, x := range []float32{0.5, 0.25, 0.5, 0.25} {
		x := x
		group.Add(1)
		go func() {
			defer group.Done()
			for i := 0; i < 100; i++ {
				_, err := scene.ClosestHit(rays(1, rayAt(x, 0)))
				if (errors.Unwrap(err) != nil) != (x == 0.5) {
					t.Errorf("at %g: %v", x, err)
				}
			}
		}()
	}
	group.Wait()
}

func TestGeometriesOfWrongSizesAreErrors(t *testing.T) {
	scene := layers(t)
	defer scene.Close()
	closed, _ := NewScene(nil)
	closed.Close()
	point := [][4]float32{{0, 0, 0, 1}}
	_, discs := scene.AddDiscs(point, nil, AllMasks)
	_, steps := scene.AddMovingMesh([][][3]float32{{{0, 0, 0}}, {}}, nil, 0, 1, AllMasks)
	_, none := scene.AddMovingMesh(nil, nil, 0, 1, AllMasks)
	_, instances := scene.AddInstances([]*Scene{closed}, []Instance{{}}, AllMasks)
	_, empty := scene.AddInstances(nil, nil, AllMasks)
	for i, err := range []error{discs, steps, none, instances, empty,
		scene.UpdateVertices(0, [][3]float32{{}}), scene.UpdateVertices(1, nil)} {
		if err == nil {
			t.Errorf("call %d did not fail", i)
		}
	}
	if err := scene.Commit(); err != nil {
		t.Error(err)
	}
}
