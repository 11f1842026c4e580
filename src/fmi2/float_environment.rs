//! The floating-point environment of the calling thread: rounding mode, flush to zero, traps and
//! exception flags. It belongs to the host.
//!
//! Compiled Rust is correct only in the default environment (rounding to nearest, subnormal numbers
//! kept, no traps). A call therefore runs in the default one, and then restores the host's, with its flags.
//!
//! On processors other than x86-64 and 64-bit Arm nothing is done.

use std::mem::MaybeUninit;

use register::Words;

/// Runs `body` in the default environment, and restores the one that was found, also after a panic.
#[inline(always)]
pub fn in_default<T>(body: impl FnOnce() -> T) -> T {
    // They stay in one place, since each copy would be waited for.
    let mut place = MaybeUninit::uninit();
    let found = register::read(&mut place);
    let wanted = register::with_default_control(*found);
    if wanted != *found {
        register::write(&wanted);
    }
    let _restored = Restored(found);
    body()
}

/// The environment that was found; put back when this is dropped.
struct Restored<'a>(&'a Words);

impl Drop for Restored<'_> {
    #[inline(always)]
    fn drop(&mut self) {
        // Written without a comparison: reading takes ten times as long as writing.
        register::write(self.0);
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
    pub fn read(place: &mut MaybeUninit<Words>) -> &Words {
        // SAFETY: writes the register's 32 bits to a place of that size. Not marked as free of
        // other effects, so that no access to memory is moved across it.
        unsafe {
            asm!("stmxcsr [{}]", in(reg) place.as_mut_ptr(), options(nostack, preserves_flags));
            place.assume_init_ref()
        }
    }

    #[inline(always)]
    pub fn write(words: &Words) {
        // SAFETY: the words were read from the register, some of its defined bits changed.
        unsafe {
            asm!("ldmxcsr [{}]", in(reg) words, options(nostack, preserves_flags));
        }
    }
}

/// FPCR and FPSR (Arm Architecture Reference Manual, section C5.2).
#[cfg(target_arch = "aarch64")]
mod register {
    use std::arch::asm;
    use std::mem::MaybeUninit;

    pub type Words = [u64; 2];

    /// Rounding mode, flush to zero, default NaN, alternative formats and trap enables.
    pub fn with_default_control([_, status]: Words) -> Words {
        [0, status]
    }

    #[inline(always)]
    pub fn read(place: &mut MaybeUninit<Words>) -> &Words {
        let (control, status): (u64, u64);
        // SAFETY: reads two registers. Not marked as free of other effects, so that no access to
        // memory is moved across it.
        unsafe {
            asm!("mrs {}, fpcr", "mrs {}, fpsr", out(reg) control, out(reg) status,
                options(nostack, preserves_flags));
        }
        place.write([control, status])
    }

    #[inline(always)]
    pub fn write(&[control, status]: &Words) {
        // Copies: of a reference the register would take the address.
        // SAFETY: the words were read from the registers, or are the default.
        unsafe {
            asm!("msr fpcr, {}", "msr fpsr, {}", in(reg) control, in(reg) status,
                options(nostack, preserves_flags));
        }
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod register {
    use std::mem::MaybeUninit;

    pub type Words = ();

    pub fn with_default_control(words: Words) -> Words {
        words
    }

    pub fn read(place: &mut MaybeUninit<Words>) -> &Words {
        place.write(())
    }

    pub fn write(_: &Words) {}
}
