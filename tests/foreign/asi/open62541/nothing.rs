//! Stands in for a library: a package needs one, and this one only names a dependency; see `build.sh`.
