"""
Exact number of extremes of the output's rate and acceleration at constant input rate.

In q = |A O4|^2 both are roots of polynomials with integer coefficients, as every float is an integer over a
power of two. With e = a1^2 - a4^2, f = a2^2 - a3^2 and

    S = ((a1+a4)^2 - q)(q - (a1-a4)^2) = (2 a1 a4 sin theta1)^2,
    T = ((a2+a3)^2 - q)(q - (a2-a3)^2) = (2 a2 a3 sin mu)^2,

theta4'' = [-e rS + s R/T^(3/2)]/(2 q^2) and theta4''' = [e (4 S - q S_q) + s rS M/T^(5/2)]/(4 q^3), where rS^2 = S
with the sign of sin theta1, s is the assembly mode, R = -f S T + q (q+f)(S_q T - S T_q)/2, M = 2 q T R_q - 4 R T -
3 q R T_q. So the extremes are the roots of P6 = (e^2 S T^3 - R^2)/q^2 and P11 = (e^2 (4 S - q S_q)^2 T^5 - S
M^2)/q^3, of degree 6 and 11, each in one theta1 of each mode, between the largest and the smallest q of
the motion; Sturm's theorem counts them. Where theta1 passes through 0 or pi, at an end of that range of q, S is zero
and so is theta4'' if R is; it then changes its sign with that of rS. Polynomials are lists of integers, lowest power first.
"""
from __future__ import annotations

from math import gcd


def count_extrema(lengths):
    """
    Return the numbers of extremes of theta4' and theta4'' in one mode, ends of the input range excluded.

    Parameters
    ----------
    lengths : sequence of 4 floats
        a1, a2, a3, a4.

    Returns
    -------
    list of 2 (int or None)
        None where the count proves nothing: the quantity is constant in a range, or its derivative may
        touch zero without a change of sign.

    """
    ratios = [float(length).as_integer_ratio() for length in lengths]
    unit = max(denominator for _, denominator in ratios)
    a1, a2, a3, a4 = (numerator * (unit // denominator) for numerator, denominator in ratios)
    e, f, q = (a1 - a4) * (a1 + a4), (a2 - a3) * (a2 + a3), [0, 1]
    S, T = _mul([(a1 + a4)**2, -1], [-(a1 - a4)**2, 1]), _mul([(a2 + a3)**2, -1], [-(a2 - a3)**2, 1])
    dS, dT = _derivative(S), _derivative(T)
    R = _add(_scale(-2 * f, _mul(S, T)),                                            # 2 R
             _mul(_mul(q, [f, 1]), _add(_mul(dS, T), _scale(-1, _mul(S, dT)))))
    M = _add(_scale(2, _mul(q, _mul(T, _derivative(R)))),                           # 2 M
             _scale(-1, _mul(R, _add(_scale(4, T), _scale(3, _mul(q, dT))))))
    low, high = max((a1 - a4)**2, (a2 - a3)**2), min((a1 + a4)**2, (a2 + a3)**2)
    if e == 0:       # both signs of theta1 for each root, and theta4''' is also zero at theta1 = pi
        numbers = [_count(P, low, high) for P in (R, M)]
        through_pi = high < (a2 + a3)**2
        return [number if number is None else 2 * number + extra
                for number, extra in zip(numbers, (0, through_pi))]
    W = _add(_scale(4, S), _scale(-1, _mul(q, dS)))
    T3 = _mul(T, _mul(T, T))
    P6 = _add(_scale(4 * e * e, _mul(S, T3)), _scale(-1, _mul(R, R)))
    P11 = _add(_scale(4 * e * e, _mul(_mul(W, W), _mul(T3, _mul(T, T)))), _scale(-1, _mul(S, _mul(M, M))))
    rates, accelerations = (_count(P, low, high) for P in (P6, P11))
    passed = ((a1 - a4)**2, (a2 - a3)**2 < (a1 - a4)**2), ((a1 + a4)**2, (a1 + a4)**2 < (a2 + a3)**2)
    extra = sum(is_passed and _value(R, q) == 0 for q, is_passed in passed)
    return [rates if rates is None else rates + extra, accelerations]


def _count(P, low, high):
    """Return the number of roots between low and high, both excluded; None if one is not simple."""
    for end in (0, low, high):
        while any(P) and _value(P, end) == 0:
            P = _divide_root(P, end)
    if not any(P):
        return None
    chain = _sturm_chain(P)
    if len(chain[-1]) > 1 and _changes(_sturm_chain(chain[-1]), low, high):
        return None
    return _changes(chain, low, high)


def _changes(chain, low, high):
    """Return the number of distinct roots of the first of a Sturm chain between low and high."""
    def sign_changes(x):
        signs = [value > 0 for value in (_value(P, x) for P in chain) if value]
        return sum(one is not other for one, other in zip(signs, signs[1:]))
    return sign_changes(low) - sign_changes(high)


def _sturm_chain(P):
    """Return the Sturm chain of P, each member divided by the content of its coefficients."""
    chain = [_primitive(P), _primitive(_derivative(P))]
    while len(chain[-1]) > 1:
        remainder = _negative_remainder(chain[-2], chain[-1])
        if not remainder:
            break
        chain.append(_primitive(remainder))
    return chain


def _negative_remainder(P, D):
    """Return -(P mod D) times a positive integer."""
    P, lead = list(P), D[-1]
    size, sign = abs(lead), 1 if lead > 0 else -1
    while len(P) >= len(D):
        factor, shift = sign * P[-1], len(P) - len(D)
        P = [size * c for c in P[:-1]]
        for i, d in enumerate(D[:-1]):
            P[shift + i] -= factor * d
        P = _trim(P)
    return [-c for c in P]


def _divide_root(P, root):
    """Return P / (q - root), which leaves no remainder."""
    quotient, carry = [], 0
    for c in reversed(P):
        carry = c + root * carry
        quotient.append(carry)
    return quotient[-2::-1]


def _trim(P):
    while P and P[-1] == 0:
        P = P[:-1]
    return P


def _primitive(P):
    P = _trim(P)
    content = gcd(*P)
    return [c // content for c in P]


def _value(P, x):
    value = 0
    for c in reversed(P):
        value = value * x + c
    return value


def _derivative(P):
    return [i * c for i, c in enumerate(P)][1:]


def _scale(factor, P):
    return [factor * c for c in P]


def _add(P, Q):
    size = max(len(P), len(Q))
    return [a + b for a, b in zip(P + [0] * (size - len(P)), Q + [0] * (size - len(Q)))]


def _mul(P, Q):
    product = [0] * (len(P) + len(Q) - 1)
    for i, a in enumerate(P):
        for j, b in enumerate(Q):
            product[i + j] += a * b
    return product
