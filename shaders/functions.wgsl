// Elementary functions of `wide` numbers, joined in front of the kernels that need them. WGSL has none of them for f64,
// and sin and tan of f32 only to an absolute error.

// e^x - 1 without cancellation: Taylor's series of a halved argument, doubled back by e(2x) = e(x) (e(x) + 2).
fn exp_minus_one(x: wide) -> wide {
    var argument = x;
    var halvings = 0u;
    while abs(argument) > wide(0.5) && halvings < 20u {
        argument *= wide(0.5);
        halvings += 1u;
    }
    // Fourteen terms: 0.5^15/15! is below the rounding of f64.
    var sum = wide(1.0);
    for (var k = 14u; k >= 2u; k--) {
        sum = wide(1.0) + argument * sum / wide(k);
    }
    var value = argument * sum;
    for (var k = 0u; k < halvings; k++) {
        value *= value + wide(2.0);
    }
    return value;
}

// e^x; by way of e^|x|, since the doubling above loses all digits of a small e^x.
fn exponential(x: wide) -> wide {
    let large = wide(1.0) + exp_minus_one(abs(x));
    return select(large, wide(1.0) / large, x < wide(0.0));
}

// ln x of a positive x in the range of f32: its logarithm y in f32, and in f64 the rest,
// ln(x e^-y) = 2 artanh((x e^-y - 1)/(x e^-y + 1)).
fn logarithm(x: wide) -> wide {
    let guess = wide(log(f32(x)));
    if !IS_WIDE_DOUBLE {
        return guess;
    }
    let ratio = x * exponential(-guess);
    let share = (ratio - wide(1.0)) / (ratio + wide(1.0));
    return guess + wide(2.0) * share * (wide(1.0) + share * share / wide(3.0));
}

// ln(1 + x), x >= 0, to a rounding of its own size: its logarithm y in f32, and the rest as above, of
// (1 + x) e^-y - 1 = (x - (e^y - 1))/e^y.
fn logarithm_of_one_plus(x: wide) -> wide {
    let guess = wide(log(f32(wide(1.0) + x)));
    let grown = exp_minus_one(guess);
    let rest = (x - grown) / (wide(1.0) + grown);
    let share = rest / (wide(2.0) + rest);
    return guess + wide(2.0) * share * (wide(1.0) + share * share / wide(3.0));
}

// tan x, |x| < pi/2, to a rounding of its own size and what a rounding of x changes it by: from tan(x/2) = sin/cos by
// their Taylor series.
fn tangent(x: wide) -> wide {
    let half = wide(0.5) * x;
    let square = half * half;
    var sine = wide(1.0);
    var cosine = wide(1.0);
    // Ten terms each: 0.8^20/20! is below the rounding of f64.
    for (var k = 10u; k >= 1u; k--) {
        let even = wide(2u * k);
        sine = wide(1.0) - square * sine / (even * (even + wide(1.0)));
        cosine = wide(1.0) - square * cosine / (even * (even - wide(1.0)));
    }
    let tangent_of_half = half * sine / cosine;
    return wide(2.0) * tangent_of_half / (wide(1.0) - tangent_of_half * tangent_of_half);
}
