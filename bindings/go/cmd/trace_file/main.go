// SPDX-License-Identifier: Apache-2.0

// See bindings/benchmark/trace_file.c.
package main

import (
	"fmt"
	"log"
	"os"
	"strconv"
	"time"
	"unsafe"

	"kiwami.org/kiwami"
)

func main() {
	bytes, err := os.ReadFile(os.Args[2])
	if err != nil || len(bytes) == 0 {
		log.Fatal("no rays: ", err)
	}
	rays := unsafe.Slice((*kiwami.Ray)(unsafe.Pointer(&bytes[0])), len(bytes)/48)
	device, err := kiwami.NewDevice(nil)
	if err != nil {
		log.Fatal(err)
	}
	scene, err := kiwami.LoadScene(device, os.Args[1], kiwami.LoadMap|kiwami.LoadTrusted)
	if err != nil {
		log.Fatal(err)
	}
	hits := make([]kiwami.Hit, len(rays))
	rounds, _ := strconv.Atoi(os.Args[3])
	for ; rounds > 0; rounds-- {
		began := time.Now()
		if err := scene.ClosestHitInto(rays, hits); err != nil {
			log.Fatal(err)
		}
		fmt.Println(time.Since(began).Seconds())
	}
}
