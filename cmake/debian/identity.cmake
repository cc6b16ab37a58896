# Who the Debian packages are from: whoever publishes them says so here, or with -D.
set(ARAP_VENDOR "the arapd authors" CACHE STRING "Who makes the packages")
set(ARAP_MAINTAINER "${ARAP_VENDOR} <arapd@example.org>" CACHE STRING "Maintainer of the packages")
set(ARAP_HOMEPAGE "" CACHE STRING "The page of the project; empty: none is told")
