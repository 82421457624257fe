"""Which eigenvalue of one system is which of a neighbouring one.

Eigenvalues are paired by where first-order perturbation theory puts them and by the overlap of their spectral
projectors P = x y* / (y* x), trace(P_a P_b): a modal assurance criterion of left with right eigenvectors. It is 1 for
the same motion and 0 for another, adds to 1 over all of the second system and does not depend on the units of the
states. Eigenvalues that (nearly) coincide, and two real ones that become a pair, have no eigenvectors of their own;
there the projector on their common invariant subspace is compared, which stays smooth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eig, schur
from scipy.optimize import linear_sum_assignment

from spaceplane.dynamics.modes import NEUTRAL_TOLERANCE, REAL_TOLERANCE
from spaceplane.dynamics.statespace import StateSpace

# Two eigenvalues nearer than this fraction of their size are one cluster.
_CLUSTER = 1e-6
# An overlap this near to 1 is the same motion.
_SAME = 0.25


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues and eigenvectors of a system at one value of a parameter, in the order of the branches.

    Attributes:
        parameter: value of the parameter.
        system: the system there.
        values: [branch] 1/s, real ones with a zero imaginary part.
        left, right: [state, branch] eigenvectors.
        clusters: groups of branches whose eigenvalues coincide.
    """

    parameter: float
    system: StateSpace
    values: np.ndarray
    left: np.ndarray
    right: np.ndarray
    clusters: tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Match:
    """A spectrum brought into the order of another.

    Attributes:
        spectrum: the second spectrum, its branches in the order of the first.
        certain: whether every branch is the same motion beyond doubt.
        joined: pairs of branches that are real on one side and conjugate on the other.
    """

    spectrum: Spectrum
    certain: bool
    joined: tuple[tuple[int, int], ...]


def spectrum(parameter: float, system: StateSpace) -> Spectrum:
    """Eigenvalues of a system, fastest first, the one with positive imaginary part of a pair before the other.

    Args:
        parameter: value of the parameter, any unit.
        system: the system there.
    """
    values, left, right = eig(system.A, left=True, right=True)
    size = np.abs(values)
    values = np.where(np.abs(values.imag) <= REAL_TOLERANCE * size, values.real + 0j, values)
    values = np.where(size <= NEUTRAL_TOLERANCE * size.max(initial=0.0), 0j, values)
    # Conjugates have the same size to the last digit, so sort by rounded size, then keep the pairs together.
    order = np.lexsort((-values.imag, -np.abs(values.imag), -values.real, -np.abs(values)))
    order = _paired(values, order)
    values = values[order]
    return Spectrum(float(parameter), system, values, left[:, order], right[:, order], _clusters(values))


def reordered(given: Spectrum, order: np.ndarray) -> Spectrum:
    """The spectrum with its branches in another order: [branch] indices of the old."""
    back = {int(old): new for new, old in enumerate(order)}
    clusters = tuple(tuple(sorted(back[i] for i in group)) for group in given.clusters)
    return replace(
        given,
        values=given.values[order],
        left=given.left[:, order],
        right=given.right[:, order],
        clusters=clusters,
    )


def nearest(a: Spectrum, b: Spectrum) -> Spectrum:
    """`b` in the order of `a` by the distance of the eigenvalues alone."""
    _, order = linear_sum_assignment(np.abs(a.values[:, None] - b.values[None, :]))
    return reordered(b, order)


def match(a: Spectrum, b: Spectrum) -> Match:
    """Bring `b` into the order of the branches of `a`.

    Where two real eigenvalues join, the one with the larger real part goes on as the upper half of the pair; where a
    pair splits, its upper half goes on as the real eigenvalue with the larger real part. There is no better reason: at
    the point itself both have the same eigenvector.
    """
    overlap = _overlap(a, b)
    predicted = _predicted(a, b)
    size = np.abs(predicted)[:, None] + np.abs(b.values)[None, :]
    floor = 1e-9 * max(np.abs(a.values).max(), np.abs(b.values).max(), 1e-300)
    gap = np.abs(predicted[:, None] - b.values[None, :]) / (size + floor)
    _, order = linear_sum_assignment(np.minimum(np.abs(overlap - 1.0), 1.0) + gap)
    order, joined, sound = _by_convention(a, b, order)
    ordered = reordered(b, order)
    if not sound:
        return Match(ordered, False, joined)
    return Match(ordered, _is_certain(a, ordered, overlap[:, order], joined), joined)


def conjugate(values: np.ndarray, branch: int) -> int:
    """Branch that holds the conjugate of a branch's eigenvalue; the branch itself if real."""
    if values[branch].imag == 0:
        return branch
    distance = np.abs(values - values[branch].conjugate())
    distance[branch] = np.inf
    return int(np.argmin(distance))


def _paired(values: np.ndarray, order: np.ndarray) -> np.ndarray:
    """The order with each conjugate directly behind its partner."""
    rest, out = [int(k) for k in order], []
    while rest:
        first = rest.pop(0)
        if values[first].imag != 0 and rest:
            partner = min(rest, key=lambda k: abs(values[k] - values[first].conjugate()))
            rest.remove(partner)
            out += [first, partner] if values[first].imag > 0 else [partner, first]
        else:
            out.append(first)
    return np.array(out, dtype=int)


def _clusters(values: np.ndarray) -> tuple[tuple[int, ...], ...]:
    n = len(values)
    size = np.abs(values)
    near = np.abs(values[:, None] - values[None, :]) <= _CLUSTER * 0.5 * (size[:, None] + size[None, :])
    links = [(i, j) for i in range(n) for j in range(i) if near[i, j]]
    return tuple(tuple(sorted(group)) for group in _groups(n, links) if len(group) > 1)


def _groups(n: int, links: list[tuple[int, int]]) -> list[set[int]]:
    """Connected components of 0..n-1."""
    groups = [{k} for k in range(n)]
    for i, j in links:
        one = next(g for g in groups if i in g)
        two = next(g for g in groups if j in g)
        if one is not two:
            groups.remove(two)
            one |= two
    return groups


def _overlap(a: Spectrum, b: Spectrum) -> np.ndarray:
    """[branch of a, branch of b] trace of the product of the spectral projectors."""
    one = np.einsum("sk,sk->k", a.left.conj(), a.right)
    two = np.einsum("sk,sk->k", b.left.conj(), b.right)
    one = np.where(np.abs(one) < 1e-14, 1e-14, one)
    two = np.where(np.abs(two) < 1e-14, 1e-14, two)
    return (a.left.conj().T @ b.right) * (b.left.conj().T @ a.right).T / np.outer(one, two)


def _predicted(a: Spectrum, b: Spectrum) -> np.ndarray:
    """[branch of a] eigenvalues at b by first-order perturbation with the difference of the matrices."""
    step = np.einsum("sk,st,tk->k", a.left.conj(), b.system.A - a.system.A, a.right)
    scale = np.einsum("sk,sk->k", a.left.conj(), a.right)
    with np.errstate(divide="ignore", invalid="ignore"):
        change = step / scale
    # Near a branch point the first order says nothing: no change is the better guess.
    limit = np.abs(a.values[:, None] - b.values[None, :]).max(axis=1)
    return a.values + np.where(np.isfinite(change) & (np.abs(change) <= limit), change, 0.0)


def _by_convention(a: Spectrum, b: Spectrum, order: np.ndarray) -> tuple[np.ndarray, tuple[tuple[int, int], ...], bool]:
    """(order, joined pairs, whether conjugates stay together), with upper half and larger real part exchanged."""
    order = order.copy()
    values = b.values[order]
    joined, sound, done = [], True, set()
    for i in range(len(order)):
        was, now = a.values[i].imag != 0, values[i].imag != 0
        if i in done or not (was or now):
            continue
        k = conjugate(a.values if was else values, i)
        done |= {i, k}
        if was and now:
            sound &= conjugate(values, i) == k and (a.values[i].imag > 0) == (values[i].imag > 0)
            continue
        if (a.values[k].imag != 0) != was or (values[k].imag != 0) != now:
            sound = False
            continue
        key = (lambda z: z.imag) if was else (lambda z: z.real)
        other = (lambda z: z.imag) if now else (lambda z: z.real)
        first, second = (i, k) if key(a.values[i]) >= key(a.values[k]) else (k, i)
        if other(values[first]) < other(values[second]):
            order[[first, second]] = order[[second, first]]
        joined.append((first, second))
    return order, tuple(joined), bool(sound)


def _is_certain(a: Spectrum, b: Spectrum, overlap: np.ndarray, joined: tuple[tuple[int, int], ...]) -> bool:
    n = len(a.values)
    links = [*joined]
    for cluster in (*a.clusters, *b.clusters):
        links += [(cluster[0], other) for other in cluster[1:]]
    for group in _groups(n, links):
        members = sorted(group)
        if len(members) == 1:
            value = overlap[members[0], members[0]]
        else:
            value = np.trace(_projector(a, members) @ _projector(b, members)) / len(members)
        if not abs(value - 1.0) < _SAME:
            return False
    return True


def _projector(given: Spectrum, members: list[int]) -> np.ndarray:
    """[state, state] spectral projector of some eigenvalues, from orthonormal bases, so that they may coincide."""
    others = [k for k in range(len(given.values)) if k not in members]
    wanted = given.values[members]
    distance = np.abs(given.values[others][:, None] - wanted[None, :]).min(initial=np.inf)
    reach = 0.5 * min(distance, 1e300)

    def inside(value: complex) -> bool:
        return bool(np.abs(value - wanted).min() <= reach)

    k = len(members)
    _, right, found = schur(given.system.A, output="complex", sort=inside)
    _, left, mirrored = schur(given.system.A.T, output="complex", sort=inside)
    if found != k or mirrored != k:
        return np.full_like(right, np.nan)
    # A.T = Z T Z* gives w = conj(Z) with w* A = T* w*: the left invariant subspace.
    X, Y = right[:, :k], left[:, :k].conj()
    return X @ np.linalg.solve(Y.conj().T @ X, Y.conj().T)
