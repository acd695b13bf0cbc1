# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's claims about noise (Figs. 4 to 6), in all ways of choosing the solution and of making the axis noisy."""

import numpy as np

from paper_results import AXIS_NOISES, MOTIONS, SELECTIONS, VERTICAL_SOLVERS, NoiseFigure

SIMILAR = 0.05
ERRORS = ("rotation", "translation")
LEE, LIU, OUR = "4pt-lee", "4pt-liu", "4pt-vertical"
SWEENEY, AXIS, FIVE = "4pt-sweeney", "4pt-axis", "5pt-martyushev"


class _Variant:
    """A figure under one way of choosing the solution and of making the axis noisy (None: it is not)."""

    def __init__(self, figure, selection, axis_noise):
        self._figure, self._selection, self._axis_noise = figure, selection, axis_noise
        self.name = ", ".join(filter(None, (selection, axis_noise)))

    def errors(self, motion, solver, error):
        """Medians at the levels above 0."""
        if self._axis_noise is None:
            prior_noise = "none"
        else:
            prior_noise = "tilt" if solver in VERTICAL_SOLVERS else self._axis_noise
        return np.array(self._figure.median(motion, self._selection, prior_noise, solver, error)[1:])

    def ratio(self, motion, one, other, error):
        """Geometric mean over the levels of the errors of one solver over those of another."""
        return float(np.exp(np.mean(np.log(self.errors(motion, one, error) / self.errors(motion, other, error)))))

    def ratios(self, one, other, motions=MOTIONS, errors=ERRORS):
        return [self.ratio(motion, one, other, error) for motion in motions for error in errors]


def _span(ratios):
    return f"{min(ratios):.2f} to {max(ratios):.2f}" if max(ratios) - min(ratios) > 0.005 else f"{ratios[0]:.2f}"


def _similar(one, other, errors=ERRORS):
    def test(variant):
        ratios = variant.ratios(one, other, errors=errors)
        return all(abs(ratio - 1.0) <= SIMILAR for ratio in ratios), f"{one}: {_span(ratios)} of {other}"
    return test


def _better(ones, others, motions=MOTIONS, errors=ERRORS, share=1.0):
    """All of `ones` better than all of `others`, in this share of the motions and errors at least."""
    def test(variant):
        ratios = {other: [ratio for one in ones for ratio in variant.ratios(one, other, motions, errors)]
                  for other in others}
        better = np.mean([ratio < 1.0 for values in ratios.values() for ratio in values])
        return better >= share, f"{' and '.join(ones)}: " + ", ".join(f"{_span(values)} of {other}"
                                                                      for other, values in ratios.items())
    return test


def _more_robust_but_sideways(variant):
    four = [solver for solver, _ in variant._figure.curves() if solver != FIVE]
    better = {motion: np.mean([ratio < 1.0 for solver in four for ratio in variant.ratios(solver, FIVE, [motion])])
              for motion in MOTIONS}
    holds = better["forward"] > 0.5 and better["random"] > 0.5 and better["sideways"] <= 0.5
    return holds, ", ".join(f"{motion}: 4-point better in {100 * share:.0f} %" for motion, share in better.items())


def _degrades(variant):
    growth = {}
    for solver in (LEE, LIU, OUR, SWEENEY, AXIS):
        growth[solver] = min(values[-1] / values[0] for motion in MOTIONS for error in ERRORS
                             for values in [variant.errors(motion, solver, error)])
    return all(value > 1.0 for value in growth.values()), "least growth from 0.1 to 1 deg: " + ", ".join(
        f"{solver} {value:.2f}" for solver, value in growth.items())


IMAGE = (
    ("4-point solvers are generally more robust to image noise than 5pt-Martyushev, except in sideways motion",
     _more_robust_but_sideways),
    ("4pt-Our-Axis and 4pt-Sweeney are comparable", _similar(AXIS, SWEENEY)),
    ("Both outperform all others in most scenarios (here: in more than half)",
     _better((AXIS, SWEENEY), (LEE, LIU, OUR), share=0.501)),
    ("4pt-Our and 4pt-Lee are similar", _similar(OUR, LEE)),
    ("Both are significantly more accurate than 4pt-Liu", _better((OUR, LEE), (LIU,))),
)
PITCH = (
    ("The accuracy of all 4-point solvers degrades with pitch noise", _degrades),
    ("4pt-Our-Axis and 4pt-Sweeney are comparable", _similar(AXIS, SWEENEY)),
    ("Both consistently outperform the other 4-point solvers", _better((AXIS, SWEENEY), (LEE, LIU, OUR))),
    ("4pt-Our and 4pt-Lee are similar", _similar(OUR, LEE)),
    ("Both are better than 4pt-Liu", _better((OUR, LEE), (LIU,))),
)
ROLL = (
    ("4pt-Our-Axis and 4pt-Sweeney are comparable", _similar(AXIS, SWEENEY)),
    ("Both have a better rotation than the three others",
     _better((AXIS, SWEENEY), (LEE, LIU, OUR), errors=("rotation",))),
    ("4pt-Our and 4pt-Lee have similar translation", _similar(OUR, LEE, errors=("translation",))),
    ("Both have a better translation than 4pt-Liu in forward and sideways motion",
     _better((OUR, LEE), (LIU,), motions=("forward", "sideways"), errors=("translation",))),
    ("4pt-Our and 4pt-Our-Axis have a better translation than 4pt-Liu in random motion",
     _better((OUR, AXIS), (LIU,), motions=("random",), errors=("translation",))),
)


def _judge_figure(section, figure, axis_noises, claims):
    variants = [_Variant(figure, selection, axis_noise) for selection in SELECTIONS for axis_noise in axis_noises]
    for text, test in claims:
        outcomes = [(variant.name,) + test(variant) for variant in variants]
        holding = [name for name, holds, _ in outcomes if holds]
        if len(holding) == len(outcomes):
            verdict = "holds"
        elif holding:
            verdict = "holds only with " + " and with ".join(holding)
        else:
            verdict = "does not hold"
        # Ways that give the same numbers are told once.
        by_numbers = {}
        for name, _, numbers in outcomes:
            by_numbers.setdefault(numbers, []).append(name)
        told = "<br>".join(f"{' and '.join(names)}: {numbers}" if len(by_numbers) > 1 else numbers
                           for numbers, names in by_numbers.items())
        yield section, text, verdict, told


def judge(directory):
    """(section, claim, verdict, numbers) of all claims; ratios are those of median errors, mean over the levels."""
    for section, stem, column, axis_noises, claims in (
            ("Fig. 4", "fig4_image_noise", "noise_px", (None,), IMAGE),
            ("Fig. 5", "fig5_pitch_noise", "noise_deg", AXIS_NOISES, PITCH),
            ("Fig. 6", "fig6_roll_noise", "noise_deg", AXIS_NOISES, ROLL)):
        yield from _judge_figure(section, NoiseFigure(directory / f"{stem}.csv", column), axis_noises, claims)
