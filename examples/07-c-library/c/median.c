#include "median.h"

double median_next(struct median *filter, double value) {
    double sorted[MEDIAN_WINDOW];
    unsigned size, i, j;

    filter->values[filter->count % MEDIAN_WINDOW] = value;
    filter->count += 1;
    size = filter->count < MEDIAN_WINDOW ? filter->count : MEDIAN_WINDOW;
    for (i = 0; i < size; i++) {
        double next = filter->values[i];
        for (j = i; j > 0 && sorted[j - 1] > next; j--)
            sorted[j] = sorted[j - 1];
        sorted[j] = next;
    }
    return sorted[size / 2];
}
