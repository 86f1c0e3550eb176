/* A median filter in C, typical of legacy robot code; the caller owns its state. */
#ifndef MEDIAN_H
#define MEDIAN_H

#define MEDIAN_WINDOW 5

struct median {
    double values[MEDIAN_WINDOW];
    unsigned count;
};

/* Adds a value and returns the median of the last MEDIAN_WINDOW values. */
double median_next(struct median *filter, double value);

#endif
