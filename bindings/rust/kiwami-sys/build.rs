// SPDX-License-Identifier: Apache-2.0
//! Links the shared library: from the folder that KIWAMI_LIBRARY_DIR names, or from the system's.
fn main() {
    println!("cargo:rerun-if-env-changed=KIWAMI_LIBRARY_DIR");
    if let Ok(folder) = std::env::var("KIWAMI_LIBRARY_DIR") {
        println!("cargo:rustc-link-search=native={folder}");
    }
    println!("cargo:rustc-link-lib=dylib=kiwami");
}
