"""Late reverberation taken off complex spectra, frame by frame, through a mute of 72 s: numpy's einsum beside rlslab.
`python3 main.py time`: of all 257 bins, with frames a second."""

import sys
import time

import numpy as np

import rlslab

TIMED = "time" in sys.argv[1:]
BINS, MICS, TAPS, DELAY, FORGETTING, QUIET = 257 if TIMED else 33, 2, 10, 2, 0.99, 1e-10
D = MICS * TAPS
HEARD, MUTED = 500, 9000    # frames of 8 ms


def spectra(rng):
    """Frames of clean and reverberant spectra, shape (BINS, MICS): speech of changing power, a mute, speech."""

    def bell(*shape):
        return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)

    room = 0.09 * bell(TAPS, BINS, MICS, MICS) * 0.75 ** np.arange(TAPS)[:, None, None, None]
    path, past = bell(BINS, MICS), np.zeros((TAPS + DELAY, BINS, MICS), complex)
    for frame in range(2 * HEARD + MUTED):
        muted = HEARD <= frame < HEARD + MUTED
        loud = 0.0 if muted else np.exp(0.7 * rng.standard_normal(BINS))
        clean = path * (loud * bell(BINS))[:, None]
        heard = clean + np.einsum("tfm,tfmn->fn", past[DELAY:], room)
        if muted:
            heard = np.zeros_like(heard)
        past = np.concatenate([heard[None], past[:-1]])
        yield clean.astype(np.complex64), heard.astype(np.complex64)


class Einsum:
    """As it is written in papers: P and the filters of all bins, three einsums a frame."""

    def __init__(self):
        self.P = np.tile(np.eye(D, dtype=np.complex64), (BINS, 1, 1))
        self.G = np.zeros((BINS, D, MICS), np.complex64)

    def __call__(self, psi, heard, power):
        Ppsi = np.einsum("fij,fj->fi", self.P, psi)
        K = Ppsi / (FORGETTING * power + np.einsum("fi,fi->f", psi.conj(), Ppsi).real)[:, None]
        e = heard - np.einsum("fi,fim->fm", psi.conj(), self.G)
        self.G = self.G + np.einsum("fi,fm->fim", K, e)
        self.P = (self.P - np.einsum("fi,fj->fij", K, Ppsi.conj())) / np.float32(FORGETTING)
        return e


class Ours:
    """A bin whose microphones are silent is held: its row is NaN, which is a missing one."""

    def __init__(self):
        self.f = rlslab.Fleet(
            "ud", BINS, D, outputs=MICS, dtype="complex64", forgetting=FORGETTING, prior_variance=1
        )

    def __call__(self, psi, heard, power):
        root = np.where(power > QUIET, 1 / np.sqrt(power), np.float32(np.nan))[:, None]
        return self.f.update(psi * root, heard * root).innovation / root


def main():
    filters, seconds = {"numpy": Einsum(), "rlslab": Ours()}, {"numpy": 0.0, "rlslab": 0.0}
    frames_in_all = 2 * HEARD + MUTED
    window = {"before the mute": range(HEARD - 100, HEARD), "after it": range(frames_in_all - 100, frames_in_all)}
    late = {(name, when): [0.0, 0.0] for name in filters for when in window}
    past = np.zeros((TAPS + DELAY, BINS, MICS), np.complex64)
    np.seterr(all="ignore")
    for frame, (clean, heard) in enumerate(spectra(np.random.default_rng(1))):
        psi = np.ascontiguousarray(past[DELAY:].transpose(1, 0, 2)).reshape(BINS, D)
        power = np.maximum((np.abs(heard) ** 2).mean(1), np.float32(QUIET))
        for name, filtered in filters.items():
            begin = time.perf_counter()
            e = filtered(psi.conj(), heard, power)
            seconds[name] += time.perf_counter() - begin
            for when, frames in window.items():
                if frame in frames:
                    late[name, when][0] += float((np.abs(e - clean) ** 2).sum())
                    late[name, when][1] += float((np.abs(heard - clean) ** 2).sum())
        past = np.concatenate([heard[None], past[:-1]])
    print("reverberation left, dB   before the mute   after it")
    for name in filters:
        left = [10 * np.log10(late[name, when][0] / late[name, when][1]) for when in window]
        print(f"{name:<24} {left[0]:15.1f} {left[1]:10.1f}")
    if TIMED:
        for name, spent in seconds.items():
            print(f"{name}: {frames_in_all / spent:.0f} frames a second")


if __name__ == "__main__":
    main()
