/* Numbers that carry a bound of what rounding has left in them, in units of U_EPSILON: of what the residual of an equation is made. */
typedef struct {
    REAL value, error;
} S_bounded;

U_FN S_bounded S_exactly(REAL value)
{
    S_bounded x;
    x.value = value;
    x.error = ZERO;
    return x;
}

U_FN S_bounded S_nearest(REAL value)
{
    S_bounded x;
    x.value = value;
    x.error = HALF * FABS(value);
    return x;
}

U_FN S_bounded S_rounded(REAL value, REAL brought)
{
    S_bounded x;
    x.value = value;
    x.error = brought + HALF * FABS(value);
    return x;
}

U_FN REAL S_certain(S_bounded x)
{
    const REAL certain = FABS(x.value) - U_EPSILON * x.error;
    return certain > 0 ? certain : ZERO;
}

U_FN S_bounded S_bounded_negative(S_bounded x)
{
    x.value = -x.value;
    return x;
}

U_FN S_bounded S_bounded_add(S_bounded a, S_bounded b)
{
    return S_rounded(a.value + b.value, a.error + b.error);
}

U_FN S_bounded S_bounded_sub(S_bounded a, S_bounded b)
{
    return S_rounded(a.value - b.value, a.error + b.error);
}

U_FN S_bounded S_bounded_mul(S_bounded a, S_bounded b)
{
    return S_rounded(a.value * b.value, FABS(a.value) * b.error + FABS(b.value) * a.error);
}

U_FN S_bounded S_bounded_div(S_bounded a, S_bounded b)
{
    const REAL value = a.value / b.value, brought = a.error + FABS(value) * b.error;
    return S_rounded(value, brought > 0 ? brought / S_certain(b) : brought);
}

//if functions
/* The value of a function with this derivative here. */
U_FN S_bounded S_bounded_function(S_bounded x, REAL value, REAL derivative)
{
    S_bounded y;
    y.value = value;
    y.error = (x.error > 0 ? FABS(derivative) * x.error : ZERO) + FABS(value);
    return y;
}

//end
//if sqrt
U_FN S_bounded S_bounded_sqrt(S_bounded x)
{
    const REAL root = SQRT(x.value);
    REAL brought = ZERO, slope, most;
    if (x.error > 0) {
        slope = x.error / (root + root);
        most = SQRT(x.error) / SQRT(U_EPSILON);
        brought = slope < most ? slope : most;
    }
    return S_rounded(root, brought);
}

//end
//each function
U_FN S_bounded S_bounded_FUNCTION(S_bounded x)
{
    const REAL value = CALLED(x.value);
    return S_bounded_function(x, value, DERIVATIVE);
}

//end
//if powf
U_FN S_bounded S_bounded_powf(S_bounded x, S_bounded exponent)
{
    const REAL value = POW(x.value, exponent.value);
    S_bounded y = S_bounded_function(x, value, exponent.value * value / x.value);
    y.error = y.error + S_bounded_function(exponent, value, value * LOG(x.value)).error;
    return y;
}

//end
//if atan2
U_FN S_bounded S_bounded_atan2(S_bounded y, S_bounded x)
{
    const REAL value = ATAN2(y.value, x.value), square = x.value * x.value + y.value * y.value;
    const REAL brought = (FABS(y.value) * x.error + FABS(x.value) * y.error) / square;
    S_bounded z;
    z.value = value;
    z.error = brought + FABS(value);
    return z;
}

//end
//if choose
/* Where rounding may have decided, the other value was as likely. */
U_FN S_bounded S_bounded_choose(S_bounded x, S_bounded negative, S_bounded otherwise)
{
    S_bounded y;
    REAL apart, most;
    y.value = S_choose(x.value, negative.value, otherwise.value);
    if (x.error == ZERO || S_certain(x) > 0) {
        y.error = S_choose(x.value, negative.error, otherwise.error);
        return y;
    }
    apart = FABS(negative.value - otherwise.value) / U_EPSILON;
    most = negative.error < otherwise.error ? otherwise.error : negative.error;
    y.error = apart + most;
    return y;
}

//end
//if recip_or_zero
U_FN S_bounded S_bounded_recip_or_zero(S_bounded x)
{
    const REAL value = S_recip_or_zero(x.value);
    return S_rounded(value, value * value * x.error);
}

//end
//each angle
U_FN S_bounded S_bounded_angle_over_sine_ORDER(S_bounded x)
{
    const REAL value = S_angle_over_sine_ORDER(x.value), distance = ONE + x.value;
    const REAL slope = AFTER * value / distance;
    S_bounded y;
    y.value = value;
    y.error = (x.error > 0 ? FABS(slope) * x.error : ZERO) + STUMPFF_ERROR * FABS(value) / FABS(distance);
    return y;
}

//end
//each family
typedef struct {
    S_bounded c[MEMBERS];
} S_bounded_stumpff_MEMBERS_family;

U_FN S_bounded_stumpff_MEMBERS_family S_bounded_stumpff_MEMBERS(S_bounded z)
{
    const S_stumpff_MEMBERS_family f = S_stumpff_MEMBERS(z.value);
    S_bounded_stumpff_MEMBERS_family g;
    U_TABLE REAL inverse[MEMBERS] = { INVERSES };
    int k;
    for (k = 0; k < MEMBERS; k++) {
        const REAL size = FABS(f.c[k]), most = size > inverse[k] ? size : inverse[k];
        g.c[k].value = f.c[k];
        g.c[k].error = HALF * most * z.error + STUMPFF_ERROR * most;
    }
    return g;
}

//end
