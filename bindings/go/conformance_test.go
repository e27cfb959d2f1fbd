// SPDX-License-Identifier: Apache-2.0

package kiwami

import (
	"errors"
	"fmt"
	"math"
	"os"
	"path/filepath"
	"strconv"
	"strings"
	"sync"
	"testing"
)

// note says that a feature was found right, for the table of the documents.
func note(features ...string) {
	path := os.Getenv("KIWAMI_FEATURES")
	if path == "" {
		return
	}
	file, err := os.OpenFile(path, os.O_APPEND|os.O_CREATE|os.O_WRONLY, 0o644)
	if err != nil {
		panic(err)
	}
	defer file.Close()
	for _, each := range features {
		fmt.Fprintln(file, each)
	}
}

// words reads the conformance vectors: answers that every binding must give, to the bit.
type words struct {
	t      *testing.T
	text   []string
	scenes map[string]*Scene
}

func readVectors(t *testing.T, name string) string {
	text, err := os.ReadFile("../conformance/" + name + ".txt")
	if err != nil {
		t.Fatal(err)
	}
	return string(text)
}

func (w *words) word() string {
	if len(w.text) == 0 {
		w.t.Fatal("the vectors end too soon")
	}
	first := w.text[0]
	w.text = w.text[1:]
	return first
}

func (w *words) number() uint64 {
	value, err := strconv.ParseUint(w.word(), 10, 64)
	if err != nil {
		w.t.Fatal(err)
	}
	return value
}

func (w *words) int() uint32         { return uint32(w.number()) }
func (w *words) float() float32      { return math.Float32frombits(w.int()) }
func (w *words) floats() [3]float32  { return [3]float32{w.float(), w.float(), w.float()} }
func (w *words) four() [4]float32    { return [4]float32{w.float(), w.float(), w.float(), w.float()} }
func (w *words) numbers() [3]uint32  { return [3]uint32{w.int(), w.int(), w.int()} }
func (w *words) expect(words string) { w.equal(w.word(), words) }

func readMany[T any](count uint32, read func() T) []T {
	values := make([]T, count)
	for i := range values {
		values[i] = read()
	}
	return values
}

func (w *words) equal(actual, expected any) {
	w.t.Helper()
	if actual != expected {
		w.t.Fatalf("%v, expected %v", actual, expected)
	}
}

func (w *words) ray() Ray {
	return Ray{w.floats(), w.float(), w.floats(), w.float(), w.float(), w.int(), w.int(), w.int()}
}

// hit reads bits: NaN and -0 count too.
func (w *words) hit() (bits [9]uint32) {
	for i := range bits {
		bits[i] = w.int()
	}
	return
}

func bitsOf(h Hit) [9]uint32 {
	float := math.Float32bits
	return [9]uint32{float(h.T), float(h.U), float(h.V), float(h.Normal[0]), float(h.Normal[1]),
		float(h.Normal[2]), h.PrimitiveID, h.GeometryID, h.InstanceID}
}

func (w *words) checkMultiHit(scene *Scene, rays []Ray) {
	maxHits, total := w.int(), w.number()
	found, err := scene.MultiHit(rays, maxHits)
	w.equal(err, nil)
	for _, offset := range found.Offsets {
		w.equal(offset, w.number())
	}
	w.equal(uint64(len(found.Hits)), total)
	for _, hit := range found.Hits {
		w.equal(bitsOf(hit), w.hit())
	}
	counts, err := scene.CountHits(rays)
	w.equal(err, nil)
	for i, count := range counts {
		if maxHits != 0 && count > maxHits {
			count = maxHits
		}
		w.equal(uint32(len(found.Of(i))), count)
	}
}

func (w *words) checkFile(device *Device, scene *Scene, rays []Ray) {
	expected, _ := scene.ClosestHit(rays)
	saved := filepath.Join(w.t.TempDir(), "scene.kiwami")
	w.equal(scene.Save(saved), nil)
	for _, path := range []string{saved, "../conformance/" + w.word()} {
		for _, flags := range []uint32{0, LoadMap, LoadMap | LoadTrusted} {
			loaded, err := LoadScene(device, path, flags)
			w.equal(err, nil)
			hits, _ := loaded.ClosestHit(rays)
			for i := range hits {
				w.equal(bitsOf(hits[i]), bitsOf(expected[i]))
			}
			loaded.Close()
		}
	}
	_, err := LoadScene(device, "../conformance/vectors.txt", 0)
	w.equal(err != nil, true)
	note("files")
}

// addGeometry adds a geometry of this kind, or says that it is none.
func (w *words) addGeometry(kind string, scene *Scene) bool {
	var err error
	switch kind {
	case "mesh":
		mask, vertices, triangles := w.int(), w.int(), w.int()
		_, err = scene.AddMesh(readMany(vertices, w.floats), readMany(triangles, w.numbers), mask)
	case "moving_mesh":
		mask, steps, begin, end := w.int(), w.int(), w.float(), w.float()
		vertices, triangles := w.int(), w.int()
		all := readMany(steps, func() [][3]float32 { return readMany(vertices, w.floats) })
		_, err = scene.AddMovingMesh(all, readMany(triangles, w.numbers), begin, end, mask)
	case "spheres":
		mask := w.int()
		_, err = scene.AddSpheres(readMany(w.int(), w.four), mask)
	case "discs":
		mask, count := w.int(), w.int()
		_, err = scene.AddDiscs(readMany(count, w.four), readMany(count, w.floats), mask)
	case "curves":
		mask, points, segments := w.int(), w.int(), w.int()
		_, err = scene.AddCurves(readMany(points, w.four), readMany(segments, w.int), mask)
	case "instances":
		mask, scenes, count := w.int(), w.int(), w.int()
		shown := readMany(scenes, func() *Scene { return w.scenes[w.word()] })
		instances := readMany(count, func() Instance {
			return Instance{w.int(), w.int(), [3][4]float32{w.four(), w.four(), w.four()}}
		})
		_, err = scene.AddInstances(shown, instances, mask)
	default:
		return false
	}
	w.equal(err, nil)
	return true
}

// change changes the scene by one statement, or says that it does not change it.
func (w *words) change(statement string, scene *Scene) bool {
	var err error
	switch statement {
	case "commit":
		err = scene.Commit()
	case "refit":
		err = scene.Refit()
	case "vertices":
		geometryID, count := w.int(), w.int()
		err = scene.UpdateVertices(geometryID, readMany(count, w.floats))
	case "enable":
		geometryID := w.int()
		err = scene.Enable(geometryID, w.int() != 0)
	case "remove":
		err = scene.Remove(w.int())
	default:
		return false
	}
	w.equal(err, nil)
	return true
}

// compare compares one kind of answer.
func (w *words) compare(statement string, device *Device, scene *Scene, rays []Ray) {
	switch statement {
	case "closest_hit":
		hits, err := scene.ClosestHit(rays)
		w.equal(err, nil)
		for _, hit := range hits {
			w.equal(bitsOf(hit), w.hit())
		}
	case "any_hit":
		occluded, err := scene.AnyHit(rays)
		w.equal(err, nil)
		for _, each := range occluded {
			w.equal(each, w.int() == 1)
		}
	case "multi_hit":
		w.checkMultiHit(scene, rays)
	case "file":
		w.checkFile(device, scene, rays)
	default:
		w.t.Fatalf("the vectors have %q", statement)
	}
}

// checkScene returns how many rays were compared.
func (w *words) checkScene(device *Device) (compared int) {
	scene, err := NewScene(device)
	w.equal(err, nil)
	w.scenes[w.word()] = scene
	var rays []Ray
	for statement := w.word(); statement != "end"; statement = w.word() {
		if statement == "rays" {
			rays = readMany(w.int(), w.ray)
			compared += len(rays)
		} else if !w.addGeometry(statement, scene) && !w.change(statement, scene) {
			w.compare(statement, device, scene, rays)
		}
	}
	return compared
}

func TestAnswersAreTheSameToTheBit(t *testing.T) {
	for name, features := range map[string][]string{
		"vectors":       {"closest hit", "any hit", "multi hit", "counts"},
		"shapes":        {"spheres, discs, curves"},
		"moving_meshes": {"moving meshes"},
		"instances":     {"instances"},
		"changes":       {"changes, refit"},
	} {
		for _, isa := range []ISA{ISAAuto, ISAScalar} {
			device, err := NewDevice(&DeviceOptions{ISA: isa, Validate: true})
			if err != nil {
				t.Fatal(err)
			}
			w := &words{t, strings.Fields(readVectors(t, name)), map[string]*Scene{}}
			w.expect("kiwami-conformance")
			w.expect("1")
			compared := 0
			for len(w.text) > 0 && w.word() == "scene" {
				compared += w.checkScene(device)
			}
			if compared < 100 {
				t.Fatalf("%s: only %d rays were compared", name, compared)
			}
			for _, scene := range w.scenes {
				scene.Close()
			}
			device.Close()
			device.Close()
		}
		note(features...)
	}
}

func TestErrorsAreTheSame(t *testing.T) {
	scene, _ := NewScene(nil)
	defer scene.Close()
	corners := [][3]float32{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}
	_, badIndex := scene.AddMesh(corners, [][3]uint32{{0, 1, 3}}, AllMasks)
	_, notCommitted := scene.ClosestHit(make([]Ray, 1))
	found := map[string]error{
		"index_beyond_vertices":   badIndex,
		"unknown_geometry":        scene.Remove(5),
		"parameter_out_of_bounds": scene.SetParameter(4, 1000),
		"not_committed":           notCommitted,
	}
	for _, line := range strings.Split(readVectors(t, "vectors"), "\n") {
		parts := strings.SplitN(line, " ", 4)
		if parts[0] != "error" {
			continue
		}
		var e *Error
		if !errors.As(found[parts[1]], &e) {
			t.Fatalf("%s: no error", parts[1])
		}
		if fmt.Sprint(e.Result) != parts[2] || e.Error() != parts[3] {
			t.Errorf("%s: %d %s, expected %s %s", parts[1], e.Result, e, parts[2], parts[3])
		}
		delete(found, parts[1])
	}
	if len(found) != 0 {
		t.Errorf("the vectors lack %v", found)
	}
	if !t.Failed() {
		note("errors")
	}
}

func TestAClosedSceneIsAnError(t *testing.T) {
	scene, _ := NewScene(nil)
	scene.Close()
	scene.Close()
	if err := scene.Commit(); err == nil {
		t.Error("a closed scene was committed")
	}
	if _, err := scene.ClosestHit(make([]Ray, 1)); err == nil {
		t.Error("a closed scene was traced")
	}
}

func TestASceneIsTracedByManyGoroutines(t *testing.T) {
	scene, _ := NewScene(nil)
	scene.AddMesh([][3]float32{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, [][3]uint32{{0, 1, 2}}, AllMasks)
	if err := scene.Commit(); err != nil {
		t.Fatal(err)
	}
	rays := make([]Ray, 100)
	for i := range rays {
		rays[i] = NewRay([3]float32{float32(i) / 50, 0.1, -1}, [3]float32{0, 0, 1})
	}
	expected, _ := scene.ClosestHit(rays)
	var group sync.WaitGroup
	for i := 0; i < 4; i++ {
		group.Add(1)
		go func() {
			defer group.Done()
			hits, err := scene.ClosestHit(rays)
			for i := range hits {
				if err != nil || hits[i] != expected[i] {
					t.Errorf("ray %d: %v, expected %v (%v)", i, hits[i], expected[i], err)
				}
			}
		}()
	}
	group.Wait()
}

func ExampleScene() {
	scene, _ := NewScene(nil)
	defer scene.Close()
	scene.AddMesh([][3]float32{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, [][3]uint32{{0, 1, 2}}, AllMasks)
	scene.Commit()
	hits, _ := scene.ClosestHit([]Ray{NewRay([3]float32{0.25, 0.25, -1}, [3]float32{0, 0, 1})})
	fmt.Printf("triangle %d at t = %g\n", hits[0].PrimitiveID, hits[0].T)
	// Output: triangle 0 at t = 1
}
