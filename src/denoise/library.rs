//! The functions of Open Image Denoise that are used, from a library that is loaded while the program runs.
//!
//! Nobody needs it to build or to render. What is unsafe about a foreign library is in this file, behind
//! functions that are not.

use std::{
    error::Error,
    ffi::{CStr, OsStr, c_char, c_int, c_void},
    mem, ptr,
};

/// `OIDNDevice` and `OIDNFilter`: pointers to what only the library knows.
type Handle = *mut c_void;

/// `OIDN_DEVICE_TYPE_CPU`, `OIDN_FORMAT_FLOAT3` and `OIDN_ERROR_NONE`.
const CPU: c_int = 1;
const FLOAT3: c_int = 3;
const NO_ERROR: c_int = 0;

/// A table of functions, from a list of them as `oidn.h` declares them.
macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// By their names in `oidn.h`.
        #[allow(non_snake_case)]
        #[derive(Debug)]
        struct Functions {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            #[allow(unsafe_code)]
            fn of(library: &libloading::Library) -> Result<Self, libloading::Error> {
                // SAFETY: a library that has these names has them with the types that `oidn.h` of version 2 gives.
                unsafe { Ok(Self { $($name: *library.get(stringify!($name))?,)* }) }
            }
        }
    };
}

functions! {
    oidnNewDevice: fn(c_int) -> Handle;
    oidnSetDeviceInt: fn(Handle, *const c_char, c_int);
    oidnSetDeviceBool: fn(Handle, *const c_char, bool);
    oidnGetDeviceInt: fn(Handle, *const c_char) -> c_int;
    oidnCommitDevice: fn(Handle);
    oidnGetDeviceError: fn(Handle, *mut *const c_char) -> c_int;
    oidnReleaseDevice: fn(Handle);
    oidnNewFilter: fn(Handle, *const c_char) -> Handle;
    oidnSetSharedFilterImage: fn(Handle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize);
    oidnSetFilterBool: fn(Handle, *const c_char, bool);
    oidnCommitFilter: fn(Handle);
    oidnExecuteFilter: fn(Handle);
    oidnReleaseFilter: fn(Handle);
}

/// A loaded library and a device of it.
#[derive(Debug)]
pub(super) struct Library {
    functions: Functions,
    /// Null before the start.
    device: Handle,
}

impl Library {
    /// Loads a file, or what the system finds under its name.
    ///
    /// # Errors
    /// What the system says.
    #[allow(unsafe_code)]
    pub(super) fn open(file: &OsStr) -> Result<Self, String> {
        // SAFETY: loading runs the library's own initialisation, which asks nothing of who loads it. That the file
        // is what its name says is for those to know who put it there.
        let library = unsafe { libloading::Library::new(file) }.map_err(|error| said(&error))?;
        let functions = Functions::of(&library).map_err(|error| said(&error))?;
        // It has threads of its own, under which it can't be unloaded.
        mem::forget(library);
        Ok(Self { functions, device: ptr::null_mut() })
    }

    /// Makes a device of the processor, with so many threads.
    ///
    /// # Errors
    /// What the library says.
    #[allow(unsafe_code)]
    pub(super) fn start(&mut self, threads: usize) -> Result<(), String> {
        let threads = c_int::try_from(threads).unwrap_or(c_int::MAX);
        let Functions { oidnNewDevice, oidnSetDeviceInt, oidnSetDeviceBool, oidnCommitDevice, .. } =
            self.functions;
        // SAFETY: the functions are those of the library, in the order it asks for, with texts that end in 0. A
        // device that could not be made is null, and asked for nothing but its error.
        unsafe {
            self.device = oidnNewDevice(CPU);
            if !self.device.is_null() {
                oidnSetDeviceInt(self.device, c"numThreads".as_ptr(), threads);
                oidnSetDeviceBool(self.device, c"setAffinity".as_ptr(), false);
                oidnCommitDevice(self.device);
            }
        }
        self.complaint()?;
        if self.device.is_null() { Err("there is no device for this processor".into()) } else { Ok(()) }
    }

    /// 10000 × major + 100 × minor + patch.
    #[allow(unsafe_code)]
    pub(super) fn version(&self) -> i32 {
        // SAFETY: the device was started, and the name ends in 0.
        unsafe { (self.functions.oidnGetDeviceInt)(self.device, c"version".as_ptr()) }
    }

    /// The filter for ray-traced pictures over some images, by the names the library has for them: three floats a
    /// pixel, row by row. `flags` are what is true of them.
    ///
    /// # Errors
    /// What the library says, or that an image has another size.
    #[allow(unsafe_code)]
    pub(super) fn filter(
        &self,
        [width, height]: [usize; 2],
        images: &[(&CStr, &[f32])],
        flags: &[&CStr],
    ) -> Result<Vec<f32>, String> {
        let floats = width * height * 3;
        if images.iter().any(|(_, image)| image.len() != floats) {
            return Err("an image has another size".into());
        }
        let mut output = vec![0.0f32; floats];
        let f = &self.functions;
        // SAFETY: each image has width × height × 3 floats without gaps, which is what strides of 0 say, and lives
        // until the filter is released. The library reads from those that it is given and writes only to `output`,
        // which nobody else has.
        unsafe {
            let filter = (f.oidnNewFilter)(self.device, c"RT".as_ptr());
            if filter.is_null() {
                return self.complaint().and(Err("it has no filter for ray-traced pictures".into()));
            }
            let set = |name: &CStr, pixels: *mut f32| {
                let pixels = pixels.cast();
                (f.oidnSetSharedFilterImage)(filter, name.as_ptr(), pixels, FLOAT3, width, height, 0, 0, 0);
            };
            images.iter().for_each(|(name, image)| set(name, image.as_ptr().cast_mut()));
            set(c"output", output.as_mut_ptr());
            flags.iter().for_each(|flag| (f.oidnSetFilterBool)(filter, flag.as_ptr(), true));
            (f.oidnCommitFilter)(filter);
            (f.oidnExecuteFilter)(filter);
            (f.oidnReleaseFilter)(filter);
        }
        self.complaint().map(|()| output)
    }

    /// The first error since this was asked last.
    #[allow(unsafe_code)]
    fn complaint(&self) -> Result<(), String> {
        let mut message = ptr::null();
        // SAFETY: a null device is allowed, and means the errors of this thread.
        let error = unsafe { (self.functions.oidnGetDeviceError)(self.device, &raw mut message) };
        if error == NO_ERROR {
            return Ok(());
        }
        if message.is_null() {
            return Err(format!("error {error}"));
        }
        // SAFETY: a message that is not null is a text that ends in 0, and stays until the next call.
        Err(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned())
    }
}

/// What the system said, rather than that it said something.
fn said(error: &libloading::Error) -> String {
    error.source().map_or_else(|| error.to_string(), ToString::to_string)
}

impl Drop for Library {
    #[allow(unsafe_code)]
    fn drop(&mut self) {
        if !self.device.is_null() {
            // SAFETY: the device is released once, and no filter of it is left.
            unsafe { (self.functions.oidnReleaseDevice)(self.device) };
        }
    }
}
