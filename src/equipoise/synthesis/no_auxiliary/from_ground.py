"""Chains of any number of links without auxiliary links: the fewest springs, and as many, all from the ground.

Lenzo (2017) balances two links; this is what his approach gives for n. Link i has the vector l_i to the next joint and
the first moment S_i, times g, with what is beyond it hung at its end. A spring s of stiffness k from height a above the
first joint to the point p_s of link j has the energy ``k/2 |l_1 + .. + l_(j-1) + p_s - a up|^2``. With u_i^s = l_i
where the spring passes link i, p_s on its own link and 0 beyond, all energies together are constant when

    sum_s k u_i^s u_j^s' = 0 for i < j,   sum_s k a u_i^s = S_i                                   (A)

All that reach link j > i pass link i with the same l_i, so that the first is sum_s k u_j^s = 0 for j > 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...model.arrays import Array
from ...model.elements import Spring
from ..arms.chain import Chain, ChainLink


def fewest_springs(chain: Chain) -> int:
    """The fewest zero-free-length springs that balance the chain when every link turns freely: sum_i rank [S_i, l_i].

    The last loaded link counts one. With all mass centres on the lines between the joints that is one for each link.

    Proof. Any spring, also one between two links, adds k u_i u_j' to the block of links i and j, where u_i (3,) is
    what its stretch has of link i, and k u_i a' to that of link i and the ground, where a (3,) is its end there. Links
    that turn freely need (A), with a' and up' in the second: the energy of a block M is tr(R_i M R_j'), constant over
    all rotations only if M = 0. Collect the sqrt(k) u_i of the N springs in V_i (3, N). The first of (A) is
    V_i V_j' = 0: the row spaces are orthogonal in R^N, so N >= sum_i rank V_i. By the second, S_i is a combination of
    the columns of V_i. It also says that some spring joins the ground to the last loaded link n or one beyond, since
    S_n is not 0; such a spring passes every link i < n with u_i = l_i, so that l_i is among the columns too. Hence
    rank V_i >= rank [S_i, l_i], and rank V_n >= 1. `springs` has as many.

    Links on hinges may do with fewer: in a plane, a mass centre off the line costs nothing.
    """
    *inner, _ = chain.loaded
    return 1 + sum(2 if link.off_line(chain.near) else 1 for link in inner)


@dataclass(frozen=True)
class _End:
    """A spring from `height` [m] above the first joint to `p` (3,) [m] from the centre of a link."""

    link: ChainLink
    stiffness: float
    height: float
    p: Array


def springs(
    chain: Chain, k: float, height: float, share: Mapping[str, float], size: Mapping[str, float]
) -> tuple[Spring, ...]:
    """The springs, as many as `fewest_springs`; solved from the last link down.

    On the last link two of stiffness k, `height` apart on the ground, pull apart: their sum is zero, their moment S_n.
    On a link between, one spring undoes the sum K of those beyond by k p = -K l, at a height that makes (A) hold along
    l; a second one, `height` above it, adds what S has across l. All heights shift together until (A) holds for link 1.

    Args:
        k: of the last link's springs [N/m]. A link alone gets one.
        height: [m] more than 0.
        share: where the spring of a link between is attached, as a share of the link's length, behind its joint.
        size: how far out the spring for what is across a link is attached [m].
    """
    first, *_ = *inner, last = chain.loaded
    g, D = chain.weight, height
    if not inner:
        ends = [_End(last, k, D, g * last.moment / (k * D))]
    else:
        p = g * last.moment / (k * D)
        ends = [_End(last, k, 0.0, -p), _End(last, k, D, p)]
    extra: list[_End] = []
    shift = 0.0
    for link in reversed(inner):
        assert link.length is not None  # only the last link has none
        K, B = sum(end.stiffness for end in ends), sum(end.stiffness * end.height for end in ends)
        across = g * link.across if link.off_line(chain.near) else np.zeros(3)
        more = float(np.linalg.norm(across)) / (D * size[link.body])  # stiffness of the spring for it
        if link is first:
            shift = (g * link.along - B) / K
            extra = [_End(link, more, D, across / (more * D))] if more else []
        else:
            part = share[link.body]
            a = (B - g * link.along) / K
            ends.append(_End(link, K / part, a, -part * (link.length + across / (K * D))))
            ends += [_End(link, more, a + D, across / (more * D))] if more else []
    ends = [_End(end.link, end.stiffness, end.height + shift, end.p) for end in ends] + extra
    order = sorted(ends, key=lambda end: [link.body for link in chain.loaded].index(end.link.body))
    count = {link.body: 0 for link in chain.loaded}
    made = []
    for end in order:
        count[end.link.body] += 1
        made.append(
            Spring(
                f"{end.link.body} spring {count[end.link.body]}",
                chain.base,
                chain.on(chain.base, first.centre + end.height * chain.up),
                end.link.body,
                chain.on(end.link.body, end.link.centre + end.p),
                end.stiffness,
            )
        )
    return tuple(made)
