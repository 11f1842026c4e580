//! The functions that save, restore and serialize an instance.

use fmi::fmi2::binding::*;

use super::calls::Call;
use super::envelope;
use super::{Component, guarded, place, slice, slice_mut};
use crate::instance::{Fault, Saved};
use crate::model::Model;

/// The saved instance behind the pointer.
///
/// # Safety
/// `state` must be null or come from [`fmi2GetFMUstate`] or
/// [`fmi2DeSerializeFMUstate`] and not have been freed: the host owes it to us
/// (FMI 2.0, section 2.1.8).
unsafe fn saved<'a>(state: fmi2FMUstate) -> Result<&'a mut Saved, Fault> {
    // SAFETY: the caller passes null, or a state that we gave and that the host has not freed.
    unsafe { place(state.cast::<Saved>(), "the state") }
}

/// Hands a saved instance to the host, which has to free it.
fn handed_out(new: Saved) -> fmi2FMUstate {
    Box::into_raw(Box::new(new)).cast()
}

pub unsafe extern "C" fn fmi2GetFMUstate<M: Model>(
    c: fmi2Component,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    guarded::<M>(c, "fmi2GetFMUstate", Call::State, |component| {
        // SAFETY: the host points to a place for one value, or passes null.
        let state = unsafe { place(FMUstate, "FMUstate") }?;
        // SAFETY: the host holds null, or a state that we gave and that it has not freed.
        match unsafe { saved(*state) } {
            Ok(before) => *before = component.instance.save(std::mem::take(before))?,
            Err(_) => *state = handed_out(component.instance.save(Saved::default())?),
        }
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2SetFMUstate<M: Model>(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
) -> fmi2Status {
    guarded::<M>(c, "fmi2SetFMUstate", Call::State, |component| {
        // SAFETY: the host passes null, or a state that we gave and that it has not freed.
        let state = unsafe { saved(FMUstate) }?;
        component.instance.restore(state)?;
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2FreeFMUstate<M: Model>(
    c: fmi2Component,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    guarded::<M>(c, "fmi2FreeFMUstate", Call::FreeState, |_| {
        // SAFETY: the host points to a place for one value, or passes null.
        if let Ok(state) = unsafe { place(FMUstate, "FMUstate") }
            && !state.is_null()
        {
            // SAFETY: a state that we gave, made of a `Box`; the host frees it once.
            drop(unsafe { Box::from_raw(state.cast::<Saved>()) });
            *state = std::ptr::null_mut();
        }
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2SerializedFMUstateSize<M: Model>(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    guarded::<M>(c, "fmi2SerializedFMUstateSize", Call::State, |_| {
        // SAFETY: the host passes null, or a state that we gave and that it has not freed.
        let state = unsafe { saved(FMUstate) }?;
        // SAFETY: the host points to a place for one value, or passes null.
        *unsafe { place(size, "size") }? = envelope::size::<M>(state.bytes());
        Ok(None)
    })
}

pub unsafe extern "C" fn fmi2SerializeFMUstate<M: Model>(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    serializedState: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    guarded::<M>(c, "fmi2SerializeFMUstate", Call::State, |_| {
        // SAFETY: the host passes null, or a state that we gave and that it has not freed.
        let state = unsafe { saved(FMUstate) }?;
        // SAFETY: the host's array has room for `size` bytes, or is null; `u8` is as wide as its
        // `char`.
        let target = unsafe { slice_mut(serializedState.cast::<u8>(), size, "serializedState") }?;
        envelope::seal::<M>(state.bytes(), target)?;
        Ok(None)
    })
}

/// What `FMUstate` points to is written and never read: it is a result alone (FMI 2.0, section 2.1.8), and a host may
/// leave it as it came from its stack. Each call makes a new state.
pub unsafe extern "C" fn fmi2DeSerializeFMUstate<M: Model>(
    c: fmi2Component,
    serializedState: *const fmi2Byte,
    size: usize,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    let body = |component: &mut Component<M>| {
        // SAFETY: the host's array holds `size` bytes, or is null; `u8` is as wide as its `char`.
        let sealed = unsafe { slice(serializedState.cast::<u8>(), size, "serializedState") }?;
        // SAFETY: the host points to a place for one value, or passes null.
        let state = unsafe { place(FMUstate, "FMUstate") }?;
        let bytes = envelope::open::<M>(sealed)?;
        *state = handed_out(component.instance.saved(bytes)?);
        Ok(None)
    };
    guarded::<M>(c, "fmi2DeSerializeFMUstate", Call::State, body)
}
