//! The floating-point environment of the calling thread: rounding mode, flush to zero, traps and
//! exception flags. It belongs to the host.
//!
//! Compiled Rust is correct only in the default environment (rounding to nearest, subnormal numbers
//! kept, no traps). A call therefore runs in the default one, and then restores the host's, with its flags.
//!
//! On processors other than x86-64 and 64-bit Arm nothing is done.

/// The environment that was found; put back when this is dropped.
pub struct FloatEnvironment {
    found: register::Words,
}

impl FloatEnvironment {
    /// Notes the environment and makes it the default one.
    #[inline(always)]
    pub fn entered() -> FloatEnvironment {
        let found = register::read();
        let wanted = register::with_default_control(found);
        if wanted != found {
            register::write(wanted);
        }
        FloatEnvironment { found }
    }
}

impl Drop for FloatEnvironment {
    #[inline(always)]
    fn drop(&mut self) {
        // Written without a comparison: reading takes ten times as long as writing.
        register::write(self.found);
    }
}

/// MXCSR (Intel SDM, volume 1, section 10.2.3). The x87 unit is not used.
#[cfg(target_arch = "x86_64")]
mod register {
    use std::arch::asm;
    use std::mem::MaybeUninit;

    pub type Words = u32;

    /// Denormals-are-zero, exception masks, rounding control, flush to zero.
    const CONTROL: u32 = 0xffc0;
    /// All exceptions masked, rounding to nearest.
    const DEFAULT: u32 = 0x1f80;

    pub fn with_default_control(words: Words) -> Words {
        words & !CONTROL | DEFAULT
    }

    #[inline(always)]
    pub fn read() -> Words {
        let mut words = MaybeUninit::<Words>::uninit();
        // SAFETY: writes the register's 32 bits to a place of that size. Not marked as free of
        // other effects, so that no access to memory is moved across it.
        unsafe {
            asm!("stmxcsr [{}]", in(reg) words.as_mut_ptr(), options(nostack, preserves_flags));
            words.assume_init()
        }
    }

    #[inline(always)]
    pub fn write(words: Words) {
        // SAFETY: the words were read from the register, some of its defined bits changed.
        unsafe {
            asm!("ldmxcsr [{}]", in(reg) &raw const words, options(nostack, preserves_flags));
        }
    }
}

/// FPCR and FPSR (Arm Architecture Reference Manual, section C5.2).
#[cfg(target_arch = "aarch64")]
mod register {
    use std::arch::asm;

    pub type Words = [u64; 2];

    /// Rounding mode, flush to zero, default NaN, alternative formats and trap enables.
    pub fn with_default_control([_, status]: Words) -> Words {
        [0, status]
    }

    #[inline(always)]
    pub fn read() -> Words {
        let (control, status): (u64, u64);
        // SAFETY: reads two registers. Not marked as free of other effects, so that no access to
        // memory is moved across it.
        unsafe {
            asm!("mrs {}, fpcr", "mrs {}, fpsr", out(reg) control, out(reg) status,
                options(nostack, preserves_flags));
        }
        [control, status]
    }

    #[inline(always)]
    pub fn write([control, status]: Words) {
        // SAFETY: the words were read from the registers, or are the default.
        unsafe {
            asm!("msr fpcr, {}", "msr fpsr, {}", in(reg) control, in(reg) status,
                options(nostack, preserves_flags));
        }
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod register {
    pub type Words = ();

    pub fn with_default_control(words: Words) -> Words {
        words
    }

    pub fn read() -> Words {}

    pub fn write(_: Words) {}
}
