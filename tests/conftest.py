"""Compiled code of the tests goes where the command's own goes: one folder per state of the sources."""

from scenarios.compile_cache import use_compile_cache

use_compile_cache()
