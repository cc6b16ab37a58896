# Who the Debian packages are from. Whoever publishes them says so:
#   script/package -DARAP_PACKAGE_MAINTAINER="Ann Example <ann@publisher.example>"
# Without that nobody is named who could be written to: names under .invalid lead nowhere (RFC 2606).
set(ARAP_VENDOR "the arapd authors" CACHE STRING "Who makes the packages")
set(ARAP_PACKAGE_MAINTAINER "${ARAP_VENDOR} <nobody@arapd.invalid>" CACHE STRING
    "Maintainer of the packages, with an address")
set(ARAP_HOMEPAGE "" CACHE STRING "The page of the project; empty: none is told")
