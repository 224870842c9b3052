/* The Python process that computes the coach: started, spoken to and ended without a risk for the host. */
#ifndef RAILSLIDE_CHILD_H
#define RAILSLIDE_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

typedef struct {
    pid_t pid;    /* 0: none */
    int socket;   /* -1: none */
    int messages; /* file that takes what it prints, -1: none */
} Child;

typedef enum { CHILD_FINE, CHILD_GONE, CHILD_TIMED_OUT } ChildResult;

extern const Child NO_CHILD;

/* Start `arguments` with a socket as its standard input; 0, or the error number of what failed. */
int child_start(Child *child, char *const arguments[]);

ChildResult child_send(Child *child, const void *data, size_t size);

/* Receive exactly `size` bytes within `limit_s` seconds. */
ChildResult child_receive(Child *child, void *data, size_t size, double limit_s);

/* Close the socket, which ends the process; kill it if it has not gone after `patience_s`. Leaves no zombie.
   Writes what became of it into `fate`, which may be NULL. */
void child_stop(Child *child, double patience_s, char *fate, size_t size);

/* The last line that it printed, cut to size; empty where there is none. To be asked before child_stop. */
void child_last_line(const Child *child, char *line, size_t size);

#endif
