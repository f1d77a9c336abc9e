add_library(mavsdk_c INTERFACE)
