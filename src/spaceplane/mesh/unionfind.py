"""Union-find and counting sort, compiled: what joins pieces into regions and control volumes."""

from __future__ import annotations

import numpy as np

from spaceplane.kernelcache import inner
from spaceplane.mesh.compiled import kernel


@kernel
def bucket(keys, buckets):
    """Counting sort: offsets [bucket + 1] and the item numbers ordered by key; negative keys are left out."""
    start = np.zeros(buckets + 1, np.int32)
    for key in keys:
        if key >= 0:
            start[key + 1] += 1
    for n in range(buckets):
        start[n + 1] += start[n]
    fill = start[:-1].copy()
    items = np.empty(start[buckets], np.int32)
    for n in range(len(keys)):
        if keys[n] >= 0:
            items[fill[keys[n]]] = n
            fill[keys[n]] += 1
    return start, items


@inner
def find(parent, n):
    """Root of item `n` in a union-find forest `parent` [item], halving the path."""
    while parent[n] != n:
        parent[n] = parent[parent[n]]
        n = parent[n]
    return n


@inner
def unite(parent, a, b):
    """Join the trees of items `a` and `b` in a forest `parent` [item]; the smaller root stays."""
    a = find(parent, a)
    b = find(parent, b)
    if a < b:
        parent[b] = a
    elif b < a:
        parent[a] = b
