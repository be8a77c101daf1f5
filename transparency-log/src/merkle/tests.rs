use proptest::prelude::*;

use super::*;

fn hash(text: &str) -> Hash {
    hex::decode(text).expect("hexadecimal").try_into().expect("32 bytes")
}

fn range(begin: u64, leaves: &[Hash]) -> LeafRange {
    let mut range = LeafRange::starting_at(begin);
    leaves.iter().for_each(|leaf| range.append(*leaf));
    range
}

fn numbered(count: u64) -> Vec<Hash> {
    (0..count).map(|number| leaf_hash(&number.to_be_bytes())).collect()
}

/// The definition of RFC 6962, section 2.1.
fn defined_root(leaves: &[Hash]) -> Hash {
    match leaves {
        [] => empty_root(),
        [leaf] => *leaf,
        _ => {
            let middle = leaves.len().next_power_of_two() / 2;
            node_hash(&defined_root(&leaves[..middle]), &defined_root(&leaves[middle..]))
        }
    }
}

/// The definition of RFC 6962, section 2.1.1.
fn defined_inclusion(index: usize, leaves: &[Hash]) -> Vec<Hash> {
    if leaves.len() == 1 {
        return Vec::new();
    }
    let (left, right) = leaves.split_at(leaves.len().next_power_of_two() / 2);
    let (mut proof, sibling) = if index < left.len() {
        (defined_inclusion(index, left), right)
    } else {
        (defined_inclusion(index - left.len(), right), left)
    };
    proof.push(defined_root(sibling));
    proof
}

/// The definition of RFC 6962, section 2.1.2: `SUBPROOF(m, D[n], b)`.
fn defined_consistency(size: usize, leaves: &[Hash], is_known: bool) -> Vec<Hash> {
    if size == leaves.len() {
        return if is_known { Vec::new() } else { vec![defined_root(leaves)] };
    }
    let (left, right) = leaves.split_at(leaves.len().next_power_of_two() / 2);
    let (mut proof, sibling) = if size <= left.len() {
        (defined_consistency(size, left, is_known), right)
    } else {
        (defined_consistency(size - left.len(), right, false), left)
    };
    proof.push(defined_root(sibling));
    proof
}

fn inclusion(index: usize, leaves: &[Hash]) -> Vec<Hash> {
    let after = range(index as u64 + 1, &leaves[index + 1..]);
    inclusion_proof(&range(0, &leaves[..index]), &after).expect("ranges of one log")
}

fn consistency(size: usize, leaves: &[Hash]) -> Vec<Hash> {
    consistency_proof(&range(0, &leaves[..size]), &range(size as u64, &leaves[size..]))
        .expect("ranges of one log")
}

/// Sizes around powers of two, at which a loop goes wrong first.
fn sizes() -> impl Iterator<Item = u64> {
    (1..66).chain(127..130).chain(255..258)
}

const ENTRIES: [&str; 8] = [
    "",
    "00",
    "10",
    "2021",
    "3031",
    "40414243",
    "5051525354555657",
    "606162636465666768696a6b6c6d6e6f",
];
const ROOTS: [&str; 9] = [
    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
    "6e340b9cffb37a989ca544e6bb780a2c78901d3fb33738768511a30617afa01d",
    "fac54203e7cc696cf0dfcb42c92a1d9dbaf70ad9e621f4bd8d98662f00e3c125",
    "aeb6bcfe274b70a14fb067a5e5578264db0fa9b51af5e0ba159158f329e06e77",
    "d37ee418976dd95753c1c73862b9398fa2a2cf9b4ff0fdfe8b30cd95209614b7",
    "4e3bbb1f7b478dcfe71fb631631519a3bca12c9aefca1612bfce4c13a86264d4",
    "76e67dadbcdf1e10e1b74ddc608abd2f98dfb16fbce75277b5232a127f2087ef",
    "ddb89be403809e325750d3d263cd78929c2942b7942a34b77e122c9594a74c8c",
    "5dc9da79a70659a9ad559cb701ded9a2ab9d823aad2f4960cfe370eff4604328",
];
const L1: &str = "96a296d224f285c67bee93c30f8a309157f0daa35dc5b87e410b78630a09cfc7";
const L2: &str = "0298d122906dcfc10892cb53a73992fc5b9f493ea4c9badb27b791b4127a7fe7";
const L3: &str = "07506a85fd9dd2f120eb694f86011e5bb4662e5c415a62917033d4a9624487e7";
const N23: &str = "5f083f0a1a33ca076a95279832580db3e0ef4584bdff1f54c8a360f50de3031e";
const N45: &str = "0ebc5d3437fbe2db158b9f126a1d118e308181031d0a949f8dededebc558ef6a";
const N46: &str = "837dbb152e9b079010717e84e865da4ebc0fa198a806d59d31bf15accef22d0e";
const N67: &str = "ca854ea128ed050b41b35ffc1b87b8eb2bde461e9e3b5596ece6b9d5975a0ae0";
const N47: &str = "6b47aaf29ee3c2af9af889bc1fb9254dabd31177f16232dd6aab035ca39bf6e4";
const N01: &str = ROOTS[2];
const N03: &str = ROOTS[4];

fn published() -> Vec<Hash> {
    ENTRIES.map(|entry| leaf_hash(&hex::decode(entry).expect("hexadecimal"))).to_vec()
}

#[test]
fn roots_are_those_of_the_published_log() {
    let leaves = published();
    for (size, root) in ROOTS.iter().enumerate() {
        assert_eq!(range(0, &leaves[..size]).root(), hash(root), "size {size}");
    }
    let check = |size, root| assert_eq!(range(0, &numbered(size)).root(), hash(root), "{size}");
    check(256, "15e2dd4973ae44de8c8cf3048fd98d17adaaea6287f4e0606a55a643617408c0");
    check(257, "d418c0873259bce7d0561ab004486112416c1c4490865415342bfe06e673146c");
    check(70_000, "0759167a0f98e35e802d46ff7c7d29d2c3f03a63a256deb6abbff357a91b63b1");
    let two = [leaves[0], leaves[1]].concat();
    let expected = "3fa13040794802ef854096500f3ea3b85b4301b0ece339e91ed7c836185b4832";
    assert_eq!(leaf_hash(&two), hash(expected), "an entry is no subtree");
}

#[test]
fn proofs_are_those_of_the_published_log() {
    let leaves = published();
    let hashes = |texts: &[&str]| texts.iter().map(|text| hash(text)).collect::<Vec<_>>();
    assert_eq!(inclusion(0, &leaves[..7]), hashes(&[L1, N23, N46]));
    assert_eq!(inclusion(6, &leaves[..7]), hashes(&[N45, N03]));
    assert_eq!(inclusion(3, &leaves), hashes(&[L2, N01, N47]));
    assert_eq!(consistency(3, &leaves[..7]), hashes(&[L2, L3, N01, N46]));
    assert_eq!(consistency(4, &leaves[..7]), hashes(&[N46]));
    assert_eq!(consistency(6, &leaves), hashes(&[N45, N67, N03]));
    assert_eq!(consistency(1, &leaves), hashes(&[L1, N23, N47]));
}

#[test]
fn every_inclusion_is_proven_as_defined_and_no_other_length_passes() {
    for size in sizes() {
        let leaves = numbered(size);
        let root = defined_root(&leaves);
        for (index, leaf) in leaves.iter().enumerate() {
            let proof = inclusion(index, &leaves);
            assert_eq!(proof, defined_inclusion(index, &leaves), "{index} of {size}");
            let check = |proof: &[Hash]| verify_inclusion(leaf, index as u64, size, &root, proof);
            assert_eq!(check(&proof), Ok(()), "{index} of {size}");
            let longer = [&proof[..], &[root]].concat();
            assert_eq!(check(&longer), Err(ProofError::WrongLength));
            if let Some((_, shorter)) = proof.split_last() {
                assert_eq!(check(shorter), Err(ProofError::WrongLength));
            }
        }
        assert_eq!(
            verify_inclusion(&leaves[0], size, size, &root, &[]),
            Err(ProofError::BeyondLog)
        );
    }
}

#[test]
fn every_extension_is_proven_as_defined_and_no_other_length_passes() {
    for size in sizes() {
        let leaves = numbered(size);
        let root = defined_root(&leaves);
        for older in 0..=leaves.len() {
            let older_root = defined_root(&leaves[..older]);
            let proof = consistency(older, &leaves);
            if older > 0 {
                assert_eq!(proof, defined_consistency(older, &leaves, true), "{older} of {size}");
            }
            let check = |older_root: &Hash, proof: &[Hash]| {
                verify_consistency((older as u64, older_root), (size, &root), proof)
            };
            assert_eq!(check(&older_root, &proof), Ok(()), "{older} of {size}");
            let longer = [&proof[..], &[root]].concat();
            assert_eq!(check(&older_root, &longer), Err(ProofError::WrongLength));
            if let Some((_, shorter)) = proof.split_last() {
                assert_eq!(check(&older_root, shorter), Err(ProofError::WrongLength));
            }
            let mut other = older_root;
            other[7] ^= 1;
            assert_eq!(check(&other, &proof), Err(ProofError::OtherRoot), "{older} of {size}");
        }
        let beyond = verify_consistency((size + 1, &root), (size, &root), &[]);
        assert_eq!(beyond, Err(ProofError::BeyondLog));
    }
}

proptest! {
    #[test]
    fn ranges_of_a_log_join_to_it(
        count in 0_u64..600, first in 0_usize..600, second in 0_usize..600,
    ) {
        let leaves = numbered(count);
        let [mut first, mut second] = [first, second].map(|place| place.min(leaves.len()));
        if first > second {
            std::mem::swap(&mut first, &mut second);
        }
        let mut joined = range(0, &leaves[..first]);
        let middle = range(first as u64, &leaves[first..second]);
        let rest = range(second as u64, &leaves[second..]);
        prop_assert_eq!(joined.join(&rest), first == second);
        if first != second {
            prop_assert!(joined.join(&middle));
            prop_assert!(joined.join(&rest));
        }
        prop_assert_eq!(&joined, &range(0, &leaves));
        prop_assert_eq!(joined.root(), defined_root(&leaves));
        let again = LeafRange::from_bytes(middle.begin(), middle.end(), &middle.to_bytes());
        prop_assert_eq!(again.as_ref(), Some(&middle));
        let longer = [&middle.to_bytes()[..], &[0; 32]].concat();
        prop_assert_eq!(LeafRange::from_bytes(middle.begin(), middle.end(), &longer), None);
        prop_assert_eq!(LeafRange::from_bytes(middle.begin(), middle.end(), &[0; 31]), None);
    }

    #[test]
    fn no_changed_bit_of_a_proof_passes(
        size in 2_u64..300, older in 1_u64..300, place in 0_usize..9, bit in 0_usize..256,
    ) {
        let leaves = numbered(size);
        let root = defined_root(&leaves);
        let older = usize::try_from(older % (size - 1) + 1).expect("small");
        let older_root = defined_root(&leaves[..older]);
        let flip = |mut proof: Vec<Hash>| {
            let place = place % proof.len();
            proof[place][bit / 8] ^= 1 << (bit % 8);
            proof
        };
        let changed = flip(consistency(older, &leaves));
        let heads = ((older as u64, &older_root), (size, &root));
        prop_assert_eq!(
            verify_consistency(heads.0, heads.1, &changed),
            Err(ProofError::OtherRoot)
        );
        let changed = flip(inclusion(older - 1, &leaves));
        prop_assert_eq!(
            verify_inclusion(&leaves[older - 1], older as u64 - 1, size, &root, &changed),
            Err(ProofError::OtherRoot)
        );
    }
}
