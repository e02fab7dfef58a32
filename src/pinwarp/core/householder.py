"""The orthogonal matrix Q of a tall thin one, never formed: products cost what its columns do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgeqrf

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reflections:
    """``Q = I - V T V^T`` of ``basis = Q [R; 0]``, in compact WY form.

    Schreiber and Van Loan, SIAM J. Sci. Stat. Comput. 10 (1989).

    Attributes
    ----------
    reflectors : (n, k) float64
        V, unit lower trapezoidal.
    triangle : (k, k)
        T, upper triangular.
    upper : (k, k)
        R.
    """

    reflectors: Matrix
    triangle: Matrix
    upper: Matrix

    @classmethod
    def of(cls, basis: Matrix) -> Reflections:
        """Factorise an (n, k) basis, n >= k.

        Examples
        --------
        >>> reflections = Reflections.of(np.array([[3.0], [4.0]]))
        >>> np.abs(reflections.rotate(np.array([[3.0], [4.0]]))).round(9).tolist()
        [[5.0], [0.0]]
        """
        columns = basis.shape[1]
        packed, tau, _, _ = dgeqrf(basis)
        reflectors = np.tril(packed[:, :columns], -1)
        reflectors[np.arange(columns), np.arange(columns)] = 1.0
        triangle = np.zeros((columns, columns))
        for j in range(columns):
            triangle[j, j] = tau[j]
            triangle[:j, j] = -tau[j] * triangle[:j, :j] @ (reflectors[:, :j].T @ reflectors[:, j])
        return cls(reflectors, triangle, np.triu(packed[:columns, :columns]))

    def rotate(self, values: Matrix) -> Matrix:
        """Return ``Q^T values``."""
        V, T = self.reflectors, self.triangle
        return values - V @ (T.T @ (V.T @ values))

    def rotate_back(self, values: Matrix) -> Matrix:
        """Return ``Q values``."""
        V, T = self.reflectors, self.triangle
        return values - V @ (T @ (V.T @ values))

    def conjugate(self, symmetric: Matrix) -> Matrix:
        """Return ``Q^T S Q`` of a symmetric (n, n) matrix: two thin products, not two full ones."""
        projected = self._taken(symmetric @ self.reflectors)
        return np.subtract(symmetric, projected, out=projected)

    def conjugate_diagonal(self, diagonal: Matrix) -> Matrix:
        """Return ``Q^T diag(d) Q`` of (n,) numbers."""
        projected = self._taken(diagonal[:, None] * self.reflectors)
        np.negative(projected, out=projected)
        projected.flat[:: len(diagonal) + 1] += diagonal
        return projected

    def _taken(self, values: Matrix) -> Matrix:
        """Return ``S - Q^T S Q = X V^T + V X^T`` from ``S V``."""
        V, T = self.reflectors, self.triangle
        X = values @ T
        X -= 0.5 * V @ (T.T @ (V.T @ X))
        return np.hstack([X, V]) @ np.hstack([V, X]).T
