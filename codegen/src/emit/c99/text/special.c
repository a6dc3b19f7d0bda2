//if choose
/* The second number where the first is below zero, the third elsewhere. */
U_FN REAL S_choose(REAL x, REAL negative, REAL otherwise)
{
    return x < 0 ? negative : otherwise;
}

//end
//if recip_or_zero
/* 1/x, and 0 where x is negligible: where it stands, the limit of the whole is zero. */
U_FN REAL S_recip_or_zero(REAL x)
{
    return FABS(x) <= NEGLIGIBLE ? ZERO : ONE / x;
}

//end
//each angle
/* The derivative, ORDER times, of a/sin(a) with respect to the cosine c of a. */
U_FN REAL S_angle_over_sine_ORDER(REAL c)
{
    REAL below, last, now, z, sum;
    int j;
    if (c > HALF) {
        z = (ONE - c) / TWO;
        sum = ONE;
        for (j = (z < SIXTYFOURTH ? FEW : MANY) - 1; j >= 0; j--)
            sum = ONE + (REAL)((ORDER + 1.0 + j) * (ORDER + 1.0 + j) / ((ORDER + 1.5 + j) * (j + 1.0))) * z * sum;
        return FIRST * sum;
    }
    below = (ONE - c) * (ONE + c);
    last = ZERO;
    now = ACOS(c) / SQRT(below);
    for (j = 0; j < ORDER; j++) {
        z = j == 0 ? -ONE : (REAL)(j * j) * last;
        last = now;
        now = ((REAL)(2 * j + 1) * c * now + z) / below;
    }
    return now;
}

//end
//each family
typedef struct {
    REAL c[MEMBERS];
} S_stumpff_MEMBERS_family;

#ifndef U_SMALL_ANGLES
/* Stumpff functions away from zero. */
U_COLD S_stumpff_MEMBERS_family S_stumpff_MEMBERS_distant(REAL z)
{
    S_stumpff_MEMBERS_family f;
    const REAL quarter = FABS(z) * QUARTER;
    /* with half the angle nothing cancels in c_2 */
    const REAL half = SQRT(quarter);
    /* what rounding took from the root: large angles would magnify it */
    const REAL scaled = half * TWO / ROOT_EPSILON;
    const REAL high = scaled - (scaled - half), low = half - high;
    REAL lost = ((quarter - high * high) - (high + high) * low - low * low) / (half + half);
    REAL c0, sine, cosine, even = ONE, odd = ONE, m;
//if upward
    REAL below, rest;
//end
    int j;
    if (z > 0) {
        const REAL s = SIN(half), c = COS(half);
        lost = FABS(lost) < ROOT_EPSILON ? lost : ZERO;
        sine = s + lost * c;
        cosine = c - lost * s;
        c0 = (cosine - sine) * (cosine + sine);
    } else {
        const REAL e = EXP(half) * (ONE + lost), inverse = ONE / e;
        sine = (e - inverse) * HALF;
        cosine = (e + inverse) * HALF;
        c0 = cosine * cosine + sine * sine;
    }
    for (j = TERMS - 1; j >= 0; j--) {
        m = (REAL)(EVEN + 2 * j);
        even = ONE - even * (z / ((m + ONE) * (m + TWO)));
        m = (REAL)(ODD + 2 * j);
        odd = ONE - odd * (z / ((m + ONE) * (m + TWO)));
    }
    even *= EVEN_FACTOR;
    odd *= ODD_FACTOR;
    DOWNWARD
    f.c[0] = c0;
//if second
    f.c[1] = sine * cosine / half;
//else
    (void)cosine;
//end
//if third
    f.c[2] = sine * sine / (quarter + quarter);
//end
//each member
    /* where nothing cancels: upward, or downward from the series */
    below = f.c[LESS];
    rest = INVERSE - below;
    f.c[MEMBER] = FABS(rest) < below * CHANGE_OVER ? f.c[MEMBER] : rest / z;
//end
    return f;
}

#endif
/* The Stumpff functions c_0(z), c_1(z), ... of which there are MEMBERS: c_0 is the cosine of the square root of z. */
U_HOT S_stumpff_MEMBERS_family S_stumpff_MEMBERS(REAL z)
{
    S_stumpff_MEMBERS_family f;
    const REAL z2 = z * z;
    REAL even = EVEN_1, odd = ODD_1;
    if (!(z < BRIEF && z > -BRIEF)) {
        const REAL z4 = z2 * z2;
        REAL more_even = EVEN_2, more_odd = ODD_2;
        if (!(z < LONG && z > -LONG)) {
#ifdef U_SMALL_ANGLES
            more_even = more_odd = NOT_A_NUMBER;
#else
            return S_stumpff_MEMBERS_distant(z);
#endif
        }
        if (!(z < SHORT && z > -SHORT)) {
            more_even = more_even + z4 * EVEN_3;
            more_odd = more_odd + z4 * ODD_3;
        }
        even = even + z4 * more_even;
        odd = odd + z4 * more_odd;
    }
    DOWNWARD
    return f;
}

//end
