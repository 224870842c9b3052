#include "child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

const Child NO_CHILD = {0, -1, -1};

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void close_it(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

/* A file without a name, open for the child's output. */
static int open_messages(void)
{
    FILE *file = tmpfile();
    if (!file)
        return -1;
    int fd = fcntl(fileno(file), F_DUPFD_CLOEXEC, 3);
    fclose(file);
    return fd;
}

int child_start(Child *child, char *const arguments[])
{
    int ends[2];
    *child = NO_CHILD;
    /* closed on exec: children of other instances must not keep this one's connection open */
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
        return errno;
    child->messages = open_messages();

    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none;
    sigemptyset(&none);
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], 0);
    for (int fd = 1; fd <= 2; fd++) {
        if (child->messages >= 0)
            posix_spawn_file_actions_adddup2(&files, child->messages, fd);
        else
            posix_spawn_file_actions_addopen(&files, fd, "/dev/null", O_WRONLY, 0);
    }
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none); /* whatever the host's thread has blocked */
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    int failure = posix_spawnp(&child->pid, arguments[0], &files, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    close(ends[1]);
    child->socket = ends[0];
    if (failure) {
        child->pid = 0;
        child_stop(child, 0.0, NULL, 0);
    }
    return failure;
}

ChildResult child_send(Child *child, const void *data, size_t size)
{
    const char *next = data;
    while (size) {
        ssize_t sent = send(child->socket, next, size, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return CHILD_GONE;
        next += sent;
        size -= (size_t)sent;
    }
    return CHILD_FINE;
}

ChildResult child_receive(Child *child, void *data, size_t size, double limit_s)
{
    char *next = data;
    const double end_s = now_s() + limit_s;
    while (size) {
        const double left_s = end_s - now_s();
        if (left_s <= 0.0)
            return CHILD_TIMED_OUT;
        struct pollfd waiting = {child->socket, POLLIN, 0};
        int ready = poll(&waiting, 1, left_s < 1e6 ? (int)(1000.0 * left_s) + 1 : -1);
        if (ready < 0 && errno != EINTR)
            return CHILD_GONE;
        if (ready <= 0)
            continue;
        ssize_t got = recv(child->socket, next, size, 0);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return CHILD_GONE;
        next += got;
        size -= (size_t)got;
    }
    return CHILD_FINE;
}

void child_last_line(const Child *child, char *line, size_t size)
{
    char text[1024];
    struct stat about;
    line[0] = '\0';
    if (child->messages < 0 || fstat(child->messages, &about))
        return;
    const off_t room = (off_t)sizeof text;
    ssize_t length = pread(child->messages, text, sizeof text, about.st_size > room ? about.st_size - room : 0);
    while (length > 0 && strchr("\r\n \t", text[length - 1]))
        length--;
    ssize_t begin = length;
    while (begin > 0 && text[begin - 1] != '\n')
        begin--;
    if (length > 0)
        snprintf(line, size, "%.*s", (int)(length - begin), text + begin);
}

static void describe(int status, bool killed, char *fate, size_t size)
{
    if (!fate)
        return;
    if (killed)
        snprintf(fate, size, "had to be killed");
    else if (WIFSIGNALED(status))
        snprintf(fate, size, "was ended by signal %d", WTERMSIG(status));
    else
        snprintf(fate, size, "ended with exit code %d", WEXITSTATUS(status));
}

void child_stop(Child *child, double patience_s, char *fate, size_t size)
{
    if (fate)
        snprintf(fate, size, "is gone");
    close_it(&child->socket);
    if (child->pid > 0) {
        const struct timespec pause = {0, 2000000};
        const double end_s = now_s() + patience_s;
        int status = 0;
        pid_t ended;
        bool killed = false;
        /* -1: somebody else in the host has taken its status already */
        while ((ended = waitpid(child->pid, &status, WNOHANG)) == 0 || (ended < 0 && errno == EINTR)) {
            if (ended == 0 && !killed && now_s() >= end_s) {
                kill(child->pid, SIGKILL);
                killed = true;
            }
            nanosleep(&pause, NULL);
        }
        if (ended > 0)
            describe(status, killed, fate, size);
    }
    close_it(&child->messages);
    child->pid = 0;
}
