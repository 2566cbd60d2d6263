// y = 0.8 u(k) - 0.3 u(k-1) and a little noise; one row is wrong. A guard finds it, and the filter goes on.
package main

import (
	"fmt"
	"log"

	"example/rlslab"
)

func main() {
	s := uint32(1)
	draw := func() float64 {
		s = 1664525*s + 1013904223
		return float64(s)/2147483648 - 1
	}
	filter, err := rlslab.New("ud", "double", 2, 0.99, "reset")
	if err != nil {
		log.Fatal(err)
	}
	defer filter.Close()
	signals, healths := rlslab.Names(rlslab.Signals), rlslab.Names(rlslab.Healths)
	u, step := 0.0, rlslab.Step{}
	for row := 0; row < 300; row++ {
		before := u
		u = draw()
		y := 0.8*u - 0.3*before + 0.01*draw()
		if row == 200 {
			y += 5
		}
		if step, err = filter.Update([]float64{u, before}, y); err != nil {
			log.Fatal(err)
		}
		if step.Signal != 0 {
			fmt.Printf("row %d: %s\n", row, signals[step.Signal])
		}
	}
	theta, err := filter.Theta()
	if err != nil {
		log.Fatal(err)
	}
	counts, err := filter.Counts()
	if err != nil {
		log.Fatal(err)
	}
	fmt.Printf("theta %.2f %.2f\n", theta[0], theta[1])
	fmt.Printf("%d outlier, %s\n", counts.Outliers, healths[step.Health])
	if _, err = rlslab.New("udd", "double", 2, 1, ""); err != nil {
		fmt.Println(err.Error()[:16])
	}
}
