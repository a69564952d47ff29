# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A slow disk and a clock that is set, by a small preloaded library."""
import mmap
import struct
import subprocess

import pytest

SOURCE = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#define LOOK 100000000      /* [ns] how soon a waiting thread sees that the clock was set */
/* The file $FAULTS: step of the system clock, delays of fsync and of write to a file [ns]. */
static volatile const int64_t *faults;
static int (*real_time)(clockid_t, struct timespec *);
static int (*real_fsync)(int), (*real_fdatasync)(int);
static ssize_t (*real_write)(int, const void *, size_t);
static int (*real_wait)(pthread_cond_t *, pthread_mutex_t *, const struct timespec *);
__attribute__((constructor)) static void begin(void) {
    real_time = dlsym(RTLD_NEXT, "clock_gettime");
    real_fsync = dlsym(RTLD_NEXT, "fsync");
    real_fdatasync = dlsym(RTLD_NEXT, "fdatasync");
    real_write = dlsym(RTLD_NEXT, "write");
    real_wait = dlvsym(RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2");
    if (!real_wait) real_wait = dlsym(RTLD_NEXT, "pthread_cond_timedwait");
    int file = open(getenv("FAULTS"), O_RDONLY);
    faults = mmap(0, 24, PROT_READ, MAP_SHARED, file, 0);
    close(file);
}
static void wait_for(int64_t ns) {
    struct timespec span = {ns / 1000000000, ns % 1000000000};
    nanosleep(&span, 0);
}
int clock_gettime(clockid_t which, struct timespec *now) {
    if (!real_time) begin();
    int done = real_time(which, now);
    if (which == CLOCK_REALTIME && faults) {
        int64_t ns = now->tv_sec * 1000000000 + now->tv_nsec + faults[0];
        now->tv_sec = ns / 1000000000;
        now->tv_nsec = ns % 1000000000;
    }
    return done;
}
/* A wait until a time of the system clock ends by that clock: much later if it is set back. */
int pthread_cond_timedwait(pthread_cond_t *condition, pthread_mutex_t *mutex,
                           const struct timespec *until) {
    if (!real_wait) begin();
    if (until->tv_sec < 1000000000)             /* of another clock */
        return real_wait(condition, mutex, until);
    for (;;) {
        struct timespec now, next;
        clock_gettime(CLOCK_REALTIME, &now);
        int64_t left = (until->tv_sec - now.tv_sec) * 1000000000 + until->tv_nsec - now.tv_nsec;
        if (left < 0) left = 0;
        int64_t wait = left < LOOK ? left : LOOK;
        real_time(CLOCK_REALTIME, &next);
        next.tv_sec += (next.tv_nsec + wait) / 1000000000;
        next.tv_nsec = (next.tv_nsec + wait) % 1000000000;
        int done = real_wait(condition, mutex, &next);
        if (done != ETIMEDOUT || wait == left) return done;
    }
}
int fsync(int file) { if (faults[1]) wait_for(faults[1]); return real_fsync(file); }
int fdatasync(int file) { if (faults[1]) wait_for(faults[1]); return real_fdatasync(file); }
ssize_t write(int file, const void *data, size_t size) {
    struct stat about;
    if (faults && faults[2] && fstat(file, &about) == 0 && S_ISREG(about.st_mode))
        wait_for(faults[2]);
    return real_write(file, data, size);
}
"""


class Faults:
    """The library, built in a folder; ``environment``: what has a process use it."""

    def __init__(self, folder):
        source, library, self._file = folder / 'faults.c', folder / 'faults.so', folder / 'faults'
        source.write_text(SOURCE)
        subprocess.run(['cc', '-shared', '-fPIC', '-O1', '-o', library, source, '-ldl'],
                       check=True)
        self._file.write_bytes(bytes(24))
        self.environment = {'LD_PRELOAD': str(library), 'FAULTS': str(self._file)}

    def set(self, clock=0.0, fsync=0.0, write=0.0):
        """Set the step of the system clock and what fsync and write take longer [s]."""
        with self._file.open('r+b') as file, mmap.mmap(file.fileno(), 24) as shared:
            shared[:] = struct.pack('<3q', *(round(1e9 * value)
                                             for value in (clock, fsync, write)))

    def start(self, start):
        """Return what a function gives that starts a process under these faults."""
        with pytest.MonkeyPatch.context() as patch:
            for name, value in self.environment.items():
                patch.setenv(name, value)
            return start()
