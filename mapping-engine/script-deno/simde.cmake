# Where the distribution keeps the SIMDe headers, so that the build asks no one on the network.
set(FETCHCONTENT_SOURCE_DIR_SIMDE "/usr/include" CACHE PATH "SIMDe")
set(FETCHCONTENT_FULLY_DISCONNECTED ON CACHE BOOL "")
