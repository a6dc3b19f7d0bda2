#ifndef U_H
#define U_H

#include <math.h>

/* What stands before functions. */
#if defined(__CUDACC__) || defined(__HIPCC__)
#define U_FN static inline __host__ __device__
#define U_HOT static __forceinline__ __host__ __device__
#define U_OUT_OF_LINE static __noinline__ __host__ __device__
#define U_COLD static __noinline__ __host__ __device__
#define U_TABLE const
#elif defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define U_FN static inline
#define U_HOT static inline __attribute__((always_inline))
#define U_OUT_OF_LINE static __attribute__((noinline, unused))
#define U_COLD static __attribute__((noinline, cold, unused))
#define U_TABLE static const
#else
#define U_FN static inline
#define U_HOT static inline
#define U_OUT_OF_LINE static inline
#define U_COLD static inline
#define U_TABLE static const
#endif

typedef SCALAR REAL;

/* The distance from 1 to the next larger number; the largest number; and what is smaller than this has not its full precision. */
#define U_EPSILON EPSILON_VALUE
#define U_LARGEST LARGEST_VALUE
#define U_LARGEST_DOUBLE LARGEST_DOUBLE_VALUE
#define U_FLOOR FLOOR_VALUE

//if solved
/* The solver's numbers; a unit is U_EPSILON. */
//each constant
#define U_NAME VALUE /* PURPOSE */
//end

//end
typedef enum {
    U_OK = 0,
    U_NOT_FINITE, /* state, time or a control, or the state after the step, or what moves it, is infinite somewhere or not a number */
    U_NOT_ON_GROUP, /* the configuration is off its group: rotations have unit length */
    U_NO_CONVERGENCE, /* the equation was not solved in as many iterations as there may be: a smaller step helps */
    U_NO_SOLUTION, /* the equation has no solution near the state: the step is too long for this motion */
    U_SEVERAL_SOLUTIONS, /* it has several, and none is the one that the motion goes on with: a smaller step has one */
    U_SINGULAR_JACOBIAN, /* its Jacobian is singular where it is to be solved */
    U_OUTSIDE_DOMAIN, /* the solution is outside of the retraction's domain: the step turns too far */
    U_NO_DERIVATIVE, /* the step has no derivative, or an infinite one: a root or a norm is zero that has none there */
    U_NO_VELOCITY, /* no velocity belongs to the momentum */
    U_PARAMETER_NOT_FINITE, /* a parameter is infinite or not a number */
    U_NOT_SYMMETRIC, /* an inertia is not symmetric */
    U_NOT_POSITIVE_DEFINITE, /* an inertia is not positive definite */
    U_BAD_STEP /* the step is zero, infinite or not a number */
} S_status;

//each struct
/* SUMMARY */
typedef struct {
//each field
//if doc
    /* DOC */
//end
    REAL FIELD;
//end
} S_STRUCT;

//end
