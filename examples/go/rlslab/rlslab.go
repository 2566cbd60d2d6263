// Package rlslab is rlslab.h from Go.
package rlslab

// #cgo pkg-config: rlslab-c
// #include <rlslab.h>
// #include <stdlib.h>
import "C"

import (
	"errors"
	"fmt"
	"runtime"
	"unsafe"
)

// List is one of the lists of Names.
type List int

// The lists of names.
const (
	Variants List = iota
	Arithmetics
	Guards
	Controls
	Healths
	Signals
)

// Names has the names of a list, in its order.
func Names(list List) (names []string) {
	for place := 0; ; place++ {
		name := C.rlslab_name(C.int(list), C.size_t(place))
		if name == nil {
			return
		}
		names = append(names, C.GoString(name))
	}
}

// Step is what a row did.
type Step struct {
	Innovation, Residual, Gamma float64
	Health, Signal              int32
}

// Counts is what happened so far.
type Counts struct {
	Rows, Unusable, Outliers, Changes, Windups, Breakdowns int64
	Refactored, Since, HandedOver                          int64
}

// Filter is a filter; Close frees it, else the garbage collector does.
type Filter struct {
	filter *C.rlslab_filter
	size   int
}

// call runs f on one thread: the message of an error is kept for each thread.
func call(f func() C.rlslab_status) error {
	runtime.LockOSThread()
	defer runtime.UnlockOSThread()
	if f() == C.RLSLAB_OK {
		return nil
	}
	return errors.New(C.GoString(C.rlslab_message()))
}

// New makes a filter. guard: "" for none.
func New(variant, arithmetic string, size int, forgetting float64, guard string) (*Filter, error) {
	if size < 0 {
		return nil, fmt.Errorf("size %d", size)
	}
	v, a, g := C.CString(variant), C.CString(arithmetic), C.CString(guard)
	defer C.free(unsafe.Pointer(v))
	defer C.free(unsafe.Pointer(a))
	defer C.free(unsafe.Pointer(g))
	var options C.rlslab_options
	err := call(func() C.rlslab_status { return C.rlslab_defaults(&options, C.sizeof_rlslab_options) })
	if err != nil {
		return nil, err
	}
	options.size, options.forgetting = C.size_t(size), C.double(forgetting)
	if guard != "" {
		options.guard = g
	}
	out := &Filter{size: size}
	if err := call(func() C.rlslab_status { return C.rlslab_new(v, a, &options, &out.filter) }); err != nil {
		return nil, err
	}
	runtime.SetFinalizer(out, (*Filter).Close)
	return out, nil
}

// Close frees the filter; a second time it does nothing.
func (f *Filter) Close() {
	C.rlslab_free(f.filter)
	f.filter = nil
}

// Update processes one row.
func (f *Filter) Update(psi []float64, y float64) (Step, error) {
	if len(psi) != f.size {
		return Step{}, fmt.Errorf("a row of %d numbers, not %d", len(psi), f.size)
	}
	var s C.rlslab_step
	if status := C.rlslab_update(f.filter, (*C.double)(&psi[0]), C.double(y), &s); status != C.RLSLAB_OK {
		return Step{}, fmt.Errorf("status %d of rlslab.h", status)
	}
	runtime.KeepAlive(f)
	return Step{float64(s.innovation), float64(s.residual), float64(s.gamma), int32(s.health), int32(s.signal)}, nil
}

// Theta is the parameters.
func (f *Filter) Theta() ([]float64, error) {
	out := make([]float64, f.size)
	return out, call(func() C.rlslab_status { return C.rlslab_theta(f.filter, (*C.double)(&out[0])) })
}

// Gain is that of the last row.
func (f *Filter) Gain() ([]float64, error) {
	out := make([]float64, f.size)
	return out, call(func() C.rlslab_status { return C.rlslab_gain(f.filter, (*C.double)(&out[0])) })
}

// Matrix is P by columns, or P^-1 where the variant reports that.
func (f *Filter) Matrix() ([]float64, error) {
	out := make([]float64, f.size*f.size)
	return out, call(func() C.rlslab_status {
		if status := C.rlslab_covariance(f.filter, (*C.double)(&out[0])); status != C.RLSLAB_ABILITY {
			return status
		}
		return C.rlslab_information(f.filter, (*C.double)(&out[0]))
	})
}

// Counts says what happened so far.
func (f *Filter) Counts() (Counts, error) {
	var c C.rlslab_counts
	err := call(func() C.rlslab_status { return C.rlslab_count(f.filter, &c, C.sizeof_rlslab_counts) })
	return Counts{int64(c.rows), int64(c.unusable), int64(c.outliers), int64(c.changes), int64(c.windups),
		int64(c.breakdowns), int64(c.refactored), int64(c.since), int64(c.handed_over)}, err
}

// Save is the state.
func (f *Filter) Save() ([]byte, error) {
	out := make([]byte, C.rlslab_state_size(f.filter))
	return out, call(func() C.rlslab_status {
		if len(out) == 0 {
			return C.rlslab_save(f.filter, nil, 0)
		}
		return C.rlslab_save(f.filter, unsafe.Pointer(&out[0]), C.size_t(len(out)))
	})
}

// Load replaces the state.
func (f *Filter) Load(state []byte) error {
	if len(state) == 0 {
		return errors.New("an empty state")
	}
	return call(func() C.rlslab_status {
		return C.rlslab_load(f.filter, unsafe.Pointer(&state[0]), C.size_t(len(state)))
	})
}
