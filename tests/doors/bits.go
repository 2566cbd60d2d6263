// The lines of tests/portability/digest.cpp, which has what is computed, from Go. doors.sh puts this into the module of
// examples/go.
package main

import (
	"fmt"
	"log"
	"math"
	"os"

	"example/rlslab"
)

const d, rows, half = 5, 1000, 500

func hashed(numbers []float64) string {
	first, second := uint64(1), uint64(1)
	for _, x := range numbers {
		for bits, i := math.Float64bits(x), 0; i < 8; i++ {
			first = (257*first + bits&255) % 4294967291
			second = (65599*second + bits&255) % 4294967291
			bits >>= 8
		}
	}
	return fmt.Sprintf("%08x%08x", first, second)
}

func must[T any](x T, err error) T {
	if err != nil {
		log.Fatal(err)
	}
	return x
}

func main() {
	arguments := append(os.Args[1:], "", "")
	verb, folder := arguments[0], arguments[1]
	s := uint32(1)
	records := make([]float64, rows*(d+1))
	for n := range records {
		s = 1664525*s + 1013904223
		records[n] = float64(s>>8)/8388608 - 1
	}
	for _, arithmetic := range rlslab.Names(rlslab.Arithmetics) {
		for _, variant := range rlslab.Names(rlslab.Variants) {
			filter := must(rlslab.New(variant, arithmetic, d, 0.9921875, ""))
			path := folder + "/" + variant + "." + arithmetic
			from := 0
			if verb == "load" {
				must(0, filter.Load(must(os.ReadFile(path))))
				from = half
			}
			for k := from; k < rows; k++ {
				if k == half && verb == "save" {
					must(0, os.WriteFile(path, must(filter.Save()), 0o644))
				}
				row := records[k*(d+1) : (k+1)*(d+1)]
				must(filter.Update(row[:d], row[d]))
			}
			numbers := append(append(must(filter.Theta()), must(filter.Gain())...), must(filter.Matrix())...)
			fmt.Println(variant, arithmetic, hashed(numbers))
			filter.Close()
		}
	}
}
