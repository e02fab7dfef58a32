"""The warping penalty that a known noise of the landmarks asks for.

The thin-plate spline is the best linear prediction of a random field with the generalised
covariance ``-sigma^2 r`` and an affine drift, seen through noise of the variance ``tau^2``
(universal kriging with a nugget: Cressie, Statistics for Spatial Data, 1993, sections 3.4 and
5.4); the penalty is their ratio, ``s = tau^2 / sigma^2``, a length. The nugget is measured here
by repeats; the scale of the field is that under which the landmarks are likeliest. In the modes,
``g = Z^T Q2^T y``, every coordinate is independent and normal with the variance
``sigma^2 lambda_i + tau^2 = tau^2 (1 + lambda_i / s)``, so the restricted likelihood
(Patterson and Thompson 1971, Biometrika 58:545; for splines Wahba 1990, section 4.8) is, up to a
constant,

    -2 log L(s) = sum_i 3 log(1 + lambda_i / s) + |g_i|^2 / (tau^2 (1 + lambda_i / s)).

All is of the regularising convention.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import SourceFactor
from pinwarp.core.positions import quiet
from pinwarp.core.spline import displacements

Matrix = NDArray[np.float64]

# The likelihood is looked through at so many penalties, this far beyond what the modes ask for.
SAMPLES = 200
MARGIN = 1e3


@dataclass(frozen=True)
class NoiseLevel:
    """The penalty that a noise asks for.

    Attributes
    ----------
    penalty
        In source mesh units; infinity where the noise alone explains all that is not affine.
    variance
        Of the noise, in one coordinate of the destination: ``tau^2``.
    field
        The scale of the warp's own variance, ``sigma^2``, in destination units squared per source
        unit: two places a source unit apart bend ``2 sigma^2`` apart in the mean square.
    """

    penalty: float
    variance: float
    field: float


@quiet
def noise_level(factor: SourceFactor, destination: ArrayLike, variance: float) -> NoiseLevel | None:
    """Return the warping penalty that belongs to a known noise of the landmarks.

    Parameters
    ----------
    factor
        The source landmarks, from :func:`~pinwarp.core.factor.factorise`.
    destination
        (n, 3) destination landmarks.
    variance
        Of the noise in one coordinate of a destination landmark, in its unit squared; that of the
        source counts as :func:`carried_variance` carries it over.

    Returns
    -------
    NoiseLevel or None
        None where there is nothing to estimate the field from: fewer than five pairs in general
        position.

    Raises
    ------
    PinwarpError
        When the variance is negative or not finite.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> rng = np.random.default_rng(0)
    >>> source = rng.normal(size=(30, 3))
    >>> noisy = source + 0.2 * np.sin(2 * source) + 0.05 * rng.normal(size=(30, 3))
    >>> factor = factorise(source)
    >>> round(noise_level(factor, noisy, 0.05**2).penalty, 2), noise_level(factor, noisy, 0).penalty
    (0.22, 0.0)
    """
    if not (math.isfinite(variance) and variance >= 0):
        raise PinwarpError(f"The variance of the noise is {variance:.6g}: it must be 0 or more.")
    usable = factor.usable_modes
    if not usable.any():
        return None
    displacement, _, _ = displacements(factor, destination)
    values = factor.modes[0][usable]
    powers = np.sum((factor.modes_at_landmarks[:, usable].T @ displacement) ** 2, axis=1)
    # Mode by mode the likeliest field is this; without noise it is the answer.
    noiseless = float(np.mean(powers / (3 * values)))
    if variance == 0 or noiseless == 0:
        return NoiseLevel(0.0 if variance == 0 else math.inf, variance, noiseless)

    def misfit(log_penalty: float) -> float:
        excess = 1 + values / math.exp(log_penalty)
        return float(np.sum(3 * np.log(excess) + powers / (variance * excess)))

    # The scale of the field cannot be larger than what any mode shows of it.
    low = math.log(variance / (MARGIN * float(np.max(powers / (3 * values)))))
    high = math.log(MARGIN * float(values[-1])) if values[-1] > 0 else low
    grid = np.linspace(min(low, math.log(float(values[0]) / MARGIN)), high, SAMPLES)
    found = [misfit(one) for one in grid]
    best = int(np.argmin(found))
    if best == SAMPLES - 1 or found[best] >= float(np.sum(powers)) / variance:
        return NoiseLevel(math.inf, variance, 0.0)
    # Here, since it brings half of scipy along, and few ask.
    from scipy.optimize import minimize_scalar

    around = (grid[max(best - 1, 0)], grid[best + 1])
    penalty = math.exp(float(minimize_scalar(misfit, bounds=around, method="bounded").x))
    return NoiseLevel(penalty, variance, variance / penalty)


def carried_variance(source: ArrayLike, destination: ArrayLike, variance: float) -> float:
    """Return what noise of the source landmarks amounts to on the destination.

    To first order a source landmark that is off by ``e`` misses by ``A e``, with the linear part of
    the warp there. That of the one affine map that fits all pairs best stands for all places: it
    does not depend on the penalty that is sought, and within a bone the map changes by less than
    a variance from a few repeats is known to. With the same noise ``v`` along every axis it is
    ``v |A|^2 / 3`` in each on average (Frobenius norm).

    Parameters
    ----------
    source, destination
        (n, 3) pairs.
    variance
        Of the noise in one coordinate of a source landmark.

    Examples
    --------
    >>> source = np.random.default_rng(0).normal(size=(9, 3))
    >>> round(carried_variance(source, 2 * source + 1, 0.25), 9)
    1.0
    """
    return variance * linear_size(source, destination) ** 2


def linear_size(source: ArrayLike, destination: ArrayLike) -> float:
    """Return how many times longer, in the mean square, the best affine map makes lengths.

    A similarity stands in where the pairs leave directions open.

    Examples
    --------
    >>> source = np.random.default_rng(0).normal(size=(9, 3))
    >>> round(linear_size(source, source @ np.diag([1.0, 1.0, 2.0])), 6) == round(2**0.5, 6)
    True
    """
    source, destination = (np.asarray(x, dtype=np.float64) for x in (source, destination))
    if not len(source):
        return 1.0
    centred, target = source - source.mean(axis=0), destination - destination.mean(axis=0)
    size = float(np.sum(centred * centred))
    if np.linalg.matrix_rank(centred, tol=1e-5 * math.sqrt(size)) < 3:
        return math.sqrt(float(np.sum(target * target)) / size) if size > 0 else 1.0
    linear = np.linalg.lstsq(centred, target, rcond=None)[0]
    return float(np.linalg.norm(linear) / math.sqrt(3))
