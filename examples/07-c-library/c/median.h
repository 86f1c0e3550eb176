/* A filter as robots' old code bases have many: C, with a state of its own that the caller keeps. */
#ifndef MEDIAN_H
#define MEDIAN_H

#define MEDIAN_WINDOW 5

struct median {
    double values[MEDIAN_WINDOW];
    unsigned count;
};

/* Takes a value, and answers the median of the last MEDIAN_WINDOW ones. */
double median_next(struct median *filter, double value);

#endif
