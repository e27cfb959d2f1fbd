// SPDX-License-Identifier: Apache-2.0

package kiwami

import (
	"math"
	"strings"
	"testing"
)

func (w *words) long() uint64    { return uint64(w.int()) | uint64(w.int())<<32 }
func (w *words) double() float64 { return math.Float64frombits(w.long()) }

func (w *words) light() Light {
	return Light{w.int(), w.int(), [4][3]float32{w.floats(), w.floats(), w.floats(), w.floats()},
		w.floats(), w.float(), w.float(), w.float(), w.float(), w.int(), w.long()}
}

func (w *words) receiver() LightReceiver {
	return LightReceiver{w.floats(), w.floats(), w.floats(), w.int(), w.long(), w.double()}
}

// playLights returns how many choices were compared.
func (w *words) playLights(device *Device) (compared int) {
	lights, err := NewLightTree(device, w.int())
	w.equal(err, nil)
	defer lights.Close()
	var receivers []LightReceiver
	var choices []LightChoice
	for word := w.word(); word != "end"; word = w.word() {
		switch word {
		case "light":
			_, err = lights.AddLights(readMany(w.int(), w.light))
		case "light_mesh":
			isTwoSided, radiance, vertices, triangles := w.int() != 0, w.float(), w.int(), w.int()
			_, err = lights.AddMesh(readMany(vertices, w.floats), readMany(triangles, w.numbers),
				radiance, isTwoSided)
		case "powers":
			first, count := w.int(), w.int()
			err = lights.SetPowers(first, readMany(count, w.float))
		case "commit":
			err = lights.Commit()
		case "refit":
			err = lights.Refit()
		case "receivers":
			receivers = readMany(w.int(), w.receiver)
		case "choices":
			choices, err = lights.Sample(receivers)
			for _, each := range choices {
				w.equal(each, LightChoice{w.int(), w.int(), w.int(), w.float(), w.double()})
			}
			compared += len(choices)
		case "pdf":
			var probabilities []float32
			probabilities, err = lights.PDF(receivers, choices)
			for _, each := range probabilities {
				w.equal(math.Float32bits(each), w.int())
			}
		default:
			w.t.Fatalf("the vectors have %q", word)
		}
		w.equal(err, nil)
	}
	return compared
}

func TestChoicesAreTheSameToTheBit(t *testing.T) {
	for _, isa := range []ISA{ISAAuto, ISAScalar} {
		device, err := NewDevice(&DeviceOptions{ISA: isa, Validate: true})
		if err != nil {
			t.Fatal(err)
		}
		w := &words{t, strings.Fields(readVectors(t, "lights")), nil}
		w.expect("kiwami-conformance")
		w.expect("1")
		compared := 0
		for len(w.text) > 0 && w.word() == "lights" {
			compared += w.playLights(device)
		}
		if compared < 100 {
			t.Fatalf("only %d choices were compared", compared)
		}
		device.Close()
	}
	note("many lights")
}

func TestBadLightsAreErrors(t *testing.T) {
	lights, err := NewLightTree(nil, 0)
	if err != nil {
		t.Fatal(err)
	}
	receivers := []LightReceiver{{LinkMask: AllLinks}}
	_, notCommitted := lights.Sample(receivers)
	_, unknown := lights.AddLights([]Light{{Kind: 99}})
	_, mesh := lights.AddMesh([][3]float32{{}}, [][3]uint32{{0, 0, 1}}, 1, false)
	_, lengths := lights.PDF(receivers, nil)
	for i, err := range []error{notCommitted, unknown, mesh, lengths, lights.SetPowers(0, make([]float32, 1))} {
		if err == nil {
			t.Errorf("call %d did not fail", i)
		}
	}
	if _, err := NewLightTree(nil, 3); err == nil {
		t.Error("a tree of width 3 was made")
	}
	lights.AddLights([]Light{{Kind: LightPoint, Points: [4][3]float32{{0, 0, 1}}, Power: 2, UserID: 7, LinkMask: AllLinks}})
	if err := lights.Commit(); err != nil {
		t.Fatal(err)
	}
	if choices, err := lights.Sample(receivers); err != nil || choices[0].UserID != 7 {
		t.Error(choices, err)
	}
	lights.Close()
	lights.Close()
	if err := lights.Commit(); err == nil {
		t.Error("a closed set was committed")
	}
}
