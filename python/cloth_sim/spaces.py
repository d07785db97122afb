"""The base of environments and the space of their actions and observations: Gymnasium's where it is
installed, else ones with the same fields and methods."""
import numpy as np

try:
    from gymnasium import Env
    from gymnasium.spaces import Box
except ImportError:

    class Env:
        """The part of gymnasium.Env that needs no other class of Gymnasium."""

        metadata = {'render_modes': []}
        render_mode = None
        _np_random = None

        @property
        def unwrapped(self):
            return self

        @property
        def np_random(self):
            """Random numbers of the environment: of the seed of `reset`, or of an arbitrary one."""
            if self._np_random is None:
                self._np_random = np.random.default_rng()
            return self._np_random

        def reset(self, *, seed=None, options=None):
            """Starts the random numbers from a seed; None: they go on."""
            if seed is not None:
                self._np_random = np.random.default_rng(seed)

        def close(self):
            """Ends what the environment has started."""

        def __enter__(self):
            return self

        def __exit__(self, *_):
            self.close()
            return False

    class Box:
        """Arrays of one shape whose elements lie between bounds, which may be infinite."""

        def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
            shape = np.shape(low) if shape is None else tuple(shape)
            self.shape, self.dtype = shape, np.dtype(dtype)
            self.low = np.full(shape, low, self.dtype)
            self.high = np.full(shape, high, self.dtype)
            self._random = None
            self.seed(seed)

        @property
        def np_random(self):
            return self._random

        def seed(self, seed=None):
            """Starts the random numbers of `sample` from a seed; None: from an arbitrary one."""
            self._random = np.random.default_rng(seed)
            return seed

        def sample(self):
            """A random element: uniform where both bounds are finite, exponential above or below
            one bound, normal without."""
            above, below = np.isfinite(self.low), np.isfinite(self.high)
            result = self._random.normal(size=self.shape)
            tail = self._random.exponential(size=self.shape)
            result = np.where(above & ~below, np.where(above, self.low, 0) + tail, result)
            result = np.where(below & ~above, np.where(below, self.high, 0) - tail, result)
            both = above & below
            span = self._random.uniform(size=self.shape)
            low, high = np.where(both, self.low, 0), np.where(both, self.high, 1)
            return np.where(both, low + span * (high - low), result).astype(self.dtype)

        def contains(self, x):
            x = np.asarray(x)
            return bool(np.can_cast(x.dtype, self.dtype) and x.shape == self.shape and
                        np.all(x >= self.low) and np.all(x <= self.high))

        def __contains__(self, x):
            return self.contains(x)

        def __eq__(self, other):
            return (isinstance(other, Box) and self.shape == other.shape and
                    self.dtype == other.dtype and np.array_equal(self.low, other.low) and
                    np.array_equal(self.high, other.high))

        def __repr__(self):
            return 'Box(%s, %s, %s, %s)' % (self.low.min(initial=np.inf),
                                            self.high.max(initial=-np.inf), self.shape, self.dtype)
