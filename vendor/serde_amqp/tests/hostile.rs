//! Input of a peer that means harm: lengths that are not there, nesting without end, bytes cut off.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

use serde_amqp::{
    de::{MAX_ELEMENTS, MAX_NESTING_DEPTH},
    descriptor::Descriptor,
    from_reader, from_slice,
    lazy::LazyValue,
    primitives::{Array, Binary, OrderedMap, Symbol},
    to_vec, Error, Value,
};

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

/// Remembers the largest allocation of each thread.
struct Watched;

unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = LARGEST.try_with(|largest| largest.set(largest.get().max(layout.size())));
        System.alloc(layout)
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let _ = LARGEST.try_with(|largest| largest.set(largest.get().max(layout.size())));
        System.alloc_zeroed(layout)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        System.dealloc(pointer, layout)
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let _ = LARGEST.try_with(|largest| largest.set(largest.get().max(size)));
        System.realloc(pointer, layout, size)
    }
}

#[global_allocator]
static ALLOCATOR: Watched = Watched;

const ALLOCATION_MAX: usize = 64 * 1024;

/// Decodes by both readers; returns the errors, and fails where one succeeds or allocates much.
fn refused<T: serde::de::DeserializeOwned + std::fmt::Debug>(bytes: &[u8]) -> [Error; 2] {
    LARGEST.set(0);
    let errors = [
        from_slice::<T>(bytes).expect_err("a slice"),
        from_reader::<T>(bytes).expect_err("a reader"),
    ];
    let largest = LARGEST.get();
    assert!(
        largest <= ALLOCATION_MAX,
        "{largest} bytes for {bytes:02x?}"
    );
    errors
}

fn any_type_refuses(bytes: &[u8]) {
    refused::<Value>(bytes);
    refused::<String>(bytes);
    refused::<Symbol>(bytes);
    refused::<Binary>(bytes);
    refused::<LazyValue>(bytes);
    refused::<Array<Symbol>>(bytes);
    refused::<Vec<Value>>(bytes);
    refused::<OrderedMap<Symbol, Value>>(bytes);
}

#[test]
fn a_length_that_is_not_there_allocates_nothing() {
    // vbin32, str32, sym32, list32, map32, array32
    for code in [0xb0, 0xb1, 0xb3, 0xd0, 0xd1, 0xf0] {
        for length in [0xffff_fff0_u32, 0x4000_0000, 0x0010_0000] {
            for count in [1_u32, 2, 60_000, u32::MAX] {
                let mut bytes = vec![code];
                bytes.extend(length.to_be_bytes());
                bytes.extend(count.to_be_bytes());
                any_type_refuses(&bytes);
                // As the descriptor of a described type
                any_type_refuses(&[&[0x00], &bytes[..]].concat());
                refused::<Descriptor>(&[&[0x00], &bytes[..]].concat());
                // As the value of one
                any_type_refuses(&[&[0x00, 0x53, 0x24], &bytes[..]].concat());
                // In a list whose own size is true
                let mut list = vec![0xd0];
                list.extend((bytes.len() as u32 + 4).to_be_bytes());
                list.extend(1_u32.to_be_bytes());
                list.extend(&bytes);
                refused::<Value>(&list);
                refused::<Vec<Value>>(&list);
            }
        }
    }
}

#[test]
fn sizes_too_small_for_their_count_are_refused() {
    for bytes in [
        &[0xc0, 0x00, 0x00][..],
        &[0xc0, 0x01, 0x01, 0x40],
        &[0xc1, 0x00, 0x00],
        &[0xc1, 0x02, 0x02, 0x40, 0x40],
        // A map of three
        &[0xc1, 0x04, 0x03, 0x40, 0x40, 0x40],
        &[0xe0, 0x00, 0x00],
        &[0xe0, 0x01, 0x01, 0x40],
        // Ubyte elements that the size has no room for
        &[0xe0, 0x02, 0x01, 0x50, 0x01],
        &[0xd0, 0, 0, 0, 0, 0, 0, 0, 0],
        &[0xd1, 0, 0, 0, 3, 0, 0, 0, 0],
        &[0xf0, 0, 0, 0, 0, 0, 0, 0, 0],
        // A list in a list that is longer than the outer one
        &[0xc0, 0x04, 0x01, 0xc0, 0x03, 0x02, 0x40, 0x40],
        // A string in a list that is longer than the list
        &[0xc0, 0x03, 0x01, 0xa1, 0x03, b'a', b'b', b'c'],
    ] {
        refused::<Value>(bytes);
    }
}

#[test]
fn elements_without_bytes_are_bounded() {
    // 5,000 arrays of 60,000 times true, each claiming all that follows
    let mut bytes = Vec::new();
    for _ in 0..5_000 {
        bytes.extend([0xf0, 0, 0, 0xea, 0x65, 0, 0, 0xea, 0x60, 0x41]);
    }
    let mut list = vec![0xd0];
    list.extend((bytes.len() as u32 + 4).to_be_bytes());
    list.extend(5_000_u32.to_be_bytes());
    list.extend(&bytes);
    refused::<Value>(&list);
    let few: Value = from_slice(&[0xf0, 0, 0, 0, 5, 0, 0, 0, 4, 0x41]).expect("four");
    assert_eq!(few, Value::Array(Array(vec![Value::Bool(true); 4])));
}

#[test]
fn the_elements_of_one_input_are_bounded_in_all() {
    let list_of = |elements: usize| Value::List(vec![Value::Null; elements]);
    let half = MAX_ELEMENTS / 2;
    let at_most = to_vec(&Value::List(vec![list_of(half - 2), list_of(half)])).expect("encodes");
    from_slice::<Value>(&at_most).expect("the largest number");
    let above = to_vec(&Value::List(vec![list_of(half), list_of(half)])).expect("encodes");
    assert!(matches!(from_slice::<Value>(&above), Err(Error::InvalidValue)));
    assert!(matches!(from_reader::<Value>(&above[..]), Err(Error::InvalidValue)));
}

#[derive(Clone, Copy)]
enum Shape {
    Described,
    List,
    MapValue,
    MapKey,
    Array,
}

/// Returns a value around which `levels` compounds are put.
fn nested(shape: Shape, levels: usize) -> Vec<u8> {
    let mut bytes = vec![0x40];
    for _ in 0..levels {
        let size = bytes.len() as u32;
        let mut outer = Vec::with_capacity(bytes.len() + 12);
        match shape {
            Shape::Described => outer.extend([0x00, 0x53, 0x01]),
            Shape::List => {
                outer.push(0xd0);
                outer.extend((size + 4).to_be_bytes());
                outer.extend(1_u32.to_be_bytes());
            }
            Shape::MapValue | Shape::MapKey => {
                outer.push(0xd1);
                outer.extend((size + 5).to_be_bytes());
                outer.extend(2_u32.to_be_bytes());
            }
            Shape::Array => {
                outer.push(0xf0);
                outer.extend((size + 4).to_be_bytes());
                outer.extend(1_u32.to_be_bytes());
            }
        }
        if matches!(shape, Shape::MapValue) {
            outer.push(0x40);
        }
        outer.append(&mut bytes);
        if matches!(shape, Shape::MapKey) {
            outer.push(0x40);
        }
        bytes = outer;
    }
    bytes
}

const SHAPES: [Shape; 5] = [
    Shape::Described,
    Shape::List,
    Shape::MapValue,
    Shape::MapKey,
    Shape::Array,
];

#[test]
fn nesting_is_bounded_whatever_nests() {
    for shape in SHAPES {
        let deepest = nested(shape, MAX_NESTING_DEPTH);
        from_slice::<Value>(&deepest).expect("the deepest");
        from_reader::<Value>(&deepest[..]).expect("the deepest");
        for levels in [MAX_NESTING_DEPTH + 1, 200, 2_000, 8_000] {
            for error in refused::<Value>(&nested(shape, levels)) {
                assert!(matches!(error, Error::NestingTooDeep), "{error}");
            }
        }
    }
}

#[test]
fn thirty_thousand_levels_overflow_no_stack() {
    let bytes: Vec<u8> = [0x00, 0x53, 0x01].repeat(30_000);
    refused::<Value>(&bytes);
    // Sizes that are wrong do not help either
    refused::<Value>(&[0xc0, 0xff, 0x01].repeat(30_000));
    refused::<Value>(&[0xc1, 0xff, 0x02].repeat(30_000));
    refused::<Value>(&[0xe0, 0xff, 0x01].repeat(30_000));
}

fn samples() -> Vec<Vec<u8>> {
    let mut map = OrderedMap::new();
    map.insert(Value::Symbol("key".into()), Value::String("text".into()));
    map.insert(Value::Ulong(3), Value::List(vec![Value::Uint(1), Value::Null]));
    let values = [
        Value::Map(map),
        Value::Array(Array(vec![Value::Symbol("PLAIN".into()), Value::Symbol("X".into())])),
        Value::Array(Array(vec![Value::Uint(70_000), Value::Uint(80_000)])),
        Value::Binary(vec![1; 300].into()),
        Value::String("x".repeat(300)),
        Value::List(vec![Value::Long(-1); 300]),
    ];
    let mut all: Vec<_> = values.iter().map(|v| to_vec(v).expect("encodes")).collect();
    all.extend(SHAPES.map(|shape| nested(shape, 5)));
    all
}

#[test]
fn whatever_is_cut_off_is_an_error_and_no_panic() {
    assert!(from_slice::<Value>(&[]).is_err());
    assert!(from_reader::<Value>(&[][..]).is_err());
    assert!(from_slice::<LazyValue>(&[]).is_err());
    for bytes in samples() {
        from_slice::<Value>(&bytes).expect("the whole");
        from_reader::<Value>(&bytes[..]).expect("the whole");
        for end in 0..bytes.len() {
            any_type_refuses(&bytes[..end]);
        }
    }
}

#[test]
fn no_change_of_a_byte_panics_or_allocates_much() {
    for bytes in samples() {
        for at in 0..bytes.len() {
            for value in [0x00, 0x01, 0x40, 0x45, 0x7f, 0x80, 0xa3, 0xb3, 0xc0, 0xd1, 0xe0, 0xf0, 0xff] {
                let mut changed = bytes.clone();
                changed[at] = value;
                LARGEST.set(0);
                let _ = from_slice::<Value>(&changed);
                let _ = from_reader::<Value>(&changed[..]);
                let _ = from_slice::<LazyValue>(&changed);
                let _ = from_reader::<LazyValue>(&changed[..]);
                assert!(LARGEST.get() <= ALLOCATION_MAX, "{changed:02x?}");
            }
        }
    }
}

#[test]
fn an_array_of_compounds_keeps_its_constructor() {
    // array8 of two list8: (1), (2, 3)
    let bytes = [
        0xe0, 0x0c, 0x02, 0xc0, 0x03, 0x01, 0x52, 0x01, 0x05, 0x02, 0x52, 0x02, 0x52, 0x03,
    ];
    let lists: Array<Vec<u32>> = from_slice(&bytes).expect("lists");
    assert_eq!(lists, Array(vec![vec![1], vec![2, 3]]));
    // An empty array with a constructor, and what follows it
    let bytes = [0xc0, 0x07, 0x02, 0xe0, 0x02, 0x00, 0xa3, 0x52, 0x07];
    let (empty, next): (Array<Symbol>, u32) = from_slice(&bytes).expect("a tuple");
    assert_eq!((empty.len(), next), (0, 7));
}
